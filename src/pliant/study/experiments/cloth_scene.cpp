#include "pliant/study/experiments/cloth_scene.h"

#include <cmath>

#include "pliant/effects/registry.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/models/registry.h"
#include "pliant/models/solver_registry.h"

namespace pliant {

ClothLift::ClothLift(const Options& options)
    : world_(options.time_step), grid_{kWidth, kWidth, options.side, options.side} {
  Obstacle table;
  table.name = "table";
  table.shape = std::make_shared<Plane>();
  world_.add_obstacle(table);
  BodyGeometry geometry{make_grid(grid_), grid_};
  geometry.mesh.vertices.row(2).array() += 0.5 * kThickness;
  rest_ = geometry.mesh.vertices;
  const auto& model = model_registry().find("cloth");
  Body& cloth = world_.add_body(
      "cloth", model.make(parse_parameters(model.parameters, options.material, "cloth"), geometry));
  const auto add = [&](const std::string& name, const ParameterText& parameters = {}) {
    world_.add_effect(cloth, effect_registry(), name, parameters, name);
  };
  add("gravity");
  add("damping", {{"rate", "5"}});
  if (options.max_stretch > 0.0) {
    add("strain_limit", {{"max", std::to_string(options.max_stretch)}});
  }
  add("air",
      {{"volume", std::to_string(options.air)}, {"fill_time", "0.3"}, {"seal_breaks", "false"}});
  if (options.self_contact) add("self_contact", {{"thickness", std::to_string(kThickness)}});
  add("contact", {{"thickness", std::to_string(kThickness)}});
  add("friction");
  for (int k = 0; k < options.points; ++k) {
    const double x = options.points == 1 ? 0.0 : (k - 0.5) * kApart;
    Eigen::Index nearest = 0;
    (rest_.topRows<2>().colwise() - Eigen::Vector2d(x, 0.0)).colwise().norm().minCoeff(&nearest);
    held_.push_back(static_cast<int>(nearest));
    cloth.particles().fix(held_.back());
  }
  world_.set_initial_state();
  world_.set_solver(cloth, all_solvers(), options.solver, options.solver_parameters,
                    options.solver);
}

bool ClothLift::step(double rise) {
  for (const int i : held_) body().particles().x(2, i) += rise;
  return world_.step();
}

}  // namespace pliant
