#include "support/solvers/solver_systems.h"

#include <memory>
#include <utility>

#include "pliant/elements/cloth/bending_set.h"
#include "pliant/elements/cloth/cell_shear_set.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/geometry/mesh/grid.h"
#include "pliant/models/cloth/cloth_springs.h"
#include "pliant/solvers/registry.h"
#include "support/random.h"
#include "support/solvers/matrices.h"
#include "support/worlds/solids.h"

namespace pliant {

std::unique_ptr<Solver> make_solver(const std::string& name, const ParameterText& parameters) {
  const auto& entry = solver_registry().find(name);
  return entry.make(parse_parameters(entry.parameters, parameters, "test"));
}

StepReport step_of(ProjectiveSystem& system, Solver& solver, double dt) {
  StepReport report;
  report.begin(1, dt, dt);
  solver.step(system, dt, report);
  return report;
}

StepReport step_of(ProjectiveSystem& system, const std::string& solver,
                   const ParameterText& parameters, double dt) {
  const auto made = make_solver(solver, parameters);
  made->prepare(system, dt);
  return step_of(system, *made, dt);
}

ProjectiveSystem after_step(const StepProblem& problem, const std::string& solver,
                            const ParameterText& parameters) {
  ProjectiveSystem system = problem.make();
  step_of(system, solver, parameters, problem.dt);
  return system;
}

Positions prediction(const ProjectiveSystem& system, double dt) {
  const Particles& p = system.particles;
  Positions y = p.x_start;
  for (int i = 0; i < p.size(); ++i) {
    const double w = p.inverse_mass[i];
    if (w > 0.0) y.col(i) += dt * (p.v_start.col(i) + dt * w * system.external_forces.col(i));
  }
  return y;
}

double objective_after(const ProjectiveSystem& system, double dt) {
  const Particles& p = system.particles;
  const Positions displacements = p.x - prediction(system, dt);
  double sum = system.elastic_energy();
  for (int i = 0; i < p.size(); ++i) {
    if (!p.is_fixed(i)) sum += 0.5 * p.mass[i] / (dt * dt) * displacements.col(i).squaredNorm();
  }
  return sum;
}

Forces unbalanced_after(const ProjectiveSystem& system, double dt) {
  const Particles& p = system.particles;
  Forces f = (prediction(system, dt) - p.x) * (p.mass / (dt * dt)).asDiagonal();
  for (const auto& set : system.elements) set->add_forces(p.x, f);
  for (int i = 0; i < p.size(); ++i) {
    if (p.is_fixed(i)) f.col(i).setZero();
  }
  return f;
}

Eigen::MatrixXd dense_matrix(const ProjectiveSystem& system, double dt) {
  const Particles& p = system.particles;
  DenseMatrix a(p.size());
  for (const auto& set : system.elements) set->add_to_system(a);
  a.matrix.diagonal() += p.mass / (dt * dt);
  for (int i = 0; i < p.size(); ++i) {
    if (!p.is_fixed(i)) continue;
    a.matrix.row(i).setZero();
    a.matrix.col(i).setZero();
    a.matrix(i, i) = 1.0;
  }
  return a.matrix;
}

double metric(const StepReport& report, std::string_view name) {
  for (const Metric& metric : report.metrics) {
    if (metric.name == name) return metric.value;
  }
  ADD_FAILURE() << "no metric " << name;
  return 0.0;
}

bool warns(const StepReport& report, const std::string& text) {
  for (const std::string& warning : report.warnings) {
    if (warning.find(text) != std::string::npos) return true;
  }
  return false;
}

ProjectiveSystem system_at(const Positions& x, double mass) {
  ProjectiveSystem system;
  system.particles = Particles(x, Eigen::VectorXd::Constant(x.cols(), mass));
  system.external_forces.setZero(3, x.cols());
  return system;
}

void pull_down(ProjectiveSystem& system) {
  for (int i = 0; i < system.particles.size(); ++i) {
    system.external_forces.col(i) << 0.0, 0.0, -9.81 * system.particles.mass[i];
  }
}

ProjectiveSystem spring_net(int particles, int extra, double stiffness, double rest,
                            std::uint64_t seed) {
  Random random(seed);
  ProjectiveSystem system = system_at(random.positions(particles, 0.2));
  const Positions& x = system.particles.x;
  std::vector<Spring> springs;
  const auto tie = [&](int i, int j) {
    const double k = stiffness * random(0.5, 2.0);
    springs.push_back({i, j, rest * (x.col(i) - x.col(j)).norm(), k});
  };
  for (int i = 0; i + 1 < particles; ++i) tie(i, i + 1);
  for (int e = 0; e < extra * particles; ++e) {
    const int i = static_cast<int>(random(0, particles)),
              j = static_cast<int>(random(0, particles));
    if (i != j) tie(i, j);
  }
  system.elements.push_back(std::make_unique<SpringSet>("stretch", springs, particles));
  system.particles.v = random.positions(particles, 0.3);
  return system;
}

ProjectiveSystem bending_sheet(const TriangleMesh& mesh, double stiffness) {
  ProjectiveSystem system = system_at(mesh.vertices, 0.001);
  system.elements.push_back(std::make_unique<BendingSet>(mesh, stiffness));
  Random random(3);
  system.particles.v = random.positions(system.particles.size(), 0.3);
  system.particles.fix(0);
  pull_down(system);
  return system;
}

/// A woven piece, thrown about in its plane so that its cells shear.
ProjectiveSystem woven_sheet() {
  const GridOptions grid{0.2, 0.15, 7, 6};
  const TriangleMesh mesh = make_grid(grid);
  ProjectiveSystem system = system_at(mesh.vertices, 0.001);
  const int particles = system.particles.size();
  system.elements.push_back(std::make_unique<SpringSet>(
      "stretch", grid_stretch_springs(grid, {500.0, 200.0, 0.0}), particles));
  system.elements.push_back(
      std::make_unique<CellShearSet>(grid_shear_cells(grid, 50.0), particles));
  Random random(8);
  system.particles.v = random.positions(particles, 0.03);
  system.particles.fix(0);
  pull_down(system);
  return system;
}

ProjectiveSystem solid_block(const ElasticMaterial& material) {
  const TetrahedralMesh mesh = jittered_block({{0.3, 0.1, 0.1}, {6, 2, 2}}, 0.2);
  ProjectiveSystem system;
  system.particles = Particles(mesh.vertices, material.density * vertex_volumes(mesh));
  system.elements = make_solid(mesh, material);
  Random random(9);
  system.particles.v = random.positions(system.particles.size(), 0.3);
  for (int i = 0; i < system.particles.size(); ++i) {
    if (on_face(mesh, i, 0, -1)) system.particles.fix(i);
  }
  system.external_forces.setZero(3, system.particles.size());
  pull_down(system);
  return system;
}

StepProblem linear_problem() {
  return {"sheet", [] { return bending_sheet(make_grid({0.2, 0.2, 9, 9}), 1e-2); }, 0.05};
}

std::vector<StepProblem> step_problems() {
  const auto net = [](double stiffness, double rest) {
    return [stiffness, rest] {
      ProjectiveSystem system = spring_net(40, 2, stiffness, rest);
      system.particles.fix(0);
      system.particles.fix(7);
      pull_down(system);
      return system;
    };
  };
  return {{"soft_net", net(10.0, 1.0)},
          {"stiff_net", net(3e3, 1.0)},
          {"stretched_net", net(300.0, 0.5)},
          {"compressed_net", net(300.0, 1.5)},
          {"bending",
           [] {
             return bending_sheet(make_grid({0.2, 0.2, 7, 7}), 1e-4);
           }},
          {"woven", woven_sheet},
          {"solid",
           [] {
             return solid_block({1e5, 0.0, 1000.0});
           }},
          {"solid_with_volume", [] {
             return solid_block({1e5, 0.4, 1000.0});
           }}};
}

}  // namespace pliant
