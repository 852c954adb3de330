#include "pliant/study/judges/body_case.h"

#include <fmt/format.h>

#include <stdexcept>

#include "pliant/models/patch/patch.h"
#include "pliant/models/solver_registry.h"
#include "pliant/solvers/time/time_integrations.h"

namespace pliant {
namespace {

std::unique_ptr<Model> solid(TetrahedralMesh mesh, const ElasticMaterial& elastic) {
  BodyGeometry geometry;
  geometry.mesh = {mesh.vertices, boundary_triangles(mesh)};
  geometry.tetrahedra = std::move(mesh);
  PatchModel::Material material;
  material.elastic = elastic;
  material.averaged = true;
  return std::make_unique<PatchModel>(geometry, material);
}

}  // namespace

BodyCase::BodyCase(TetrahedralMesh mesh, const ElasticMaterial& material, double time_step)
    : BodyCase(solid(std::move(mesh), material), time_step) {}

BodyCase::BodyCase(std::unique_ptr<Model> model, double time_step) : world_(time_step) {
  Body& added = world_.add_body("body", std::move(model));
  rest_ = added.particles().x;
  auto held = std::make_unique<HeldCoordinates>();
  held_ = held.get();
  added.model->system().as_projective()->elements.push_back(std::move(held));
}

void BodyCase::hold_plane(double stiffness) {
  for (int i = 0; i < particles().size(); ++i) {
    if (!particles().is_fixed(i)) hold({i, 2, rest_(2, i), 1e4 * stiffness});
  }
}

void BodyCase::set_loads(const Forces& loads) {
  auto set = std::make_unique<DeadLoads>(loads);
  loads_ = set.get();
  body().model->system().as_projective()->elements.push_back(std::move(set));
}

void BodyCase::set_weight(const Eigen::Vector3d& acceleration) {
  set_loads(acceleration * particles().mass.transpose());
}

void BodyCase::start(const std::string& time_integration) {
  world_.set_initial_state();
  world_.system_changed();
  world_.set_solver(body(), all_solvers(), "newton", {{"iterations", "100"}, {"tolerance", "1e-8"}},
                    "judge");
  world_.set_time_integration(body(), time_integrations(), time_integration);
}

void BodyCase::load(int stages) {
  for (int n = 1; n <= stages; ++n) {
    loads_->set_share(static_cast<double>(n) / stages);
    step();
  }
}

void BodyCase::step() {
  if (!world_.step()) throw std::runtime_error(world_.failure());
  const StepReport& report = body().report;
  constexpr double kLeft = 1e-4;  // of the forces, what is left out of balance
  if (report.ended_by == EndedBy::kIterations || !(report.residual < kLeft)) {
    throw std::runtime_error(fmt::format(
        "newton did not converge: ended by {} after {} iterations, a residual of {:.2g} "
        "is left",
        to_string(report.ended_by), report.iterations, report.residual));
  }
}

}  // namespace pliant
