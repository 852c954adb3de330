#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/models/reduced/reduced_body.h"
#include "pliant/models/solver_registry.h"
#include "support/worlds/worlds.h"
#include "unit/models/reduced/stvk_examples.h"

namespace pliant {

/// A beam along x, 1 m by 0.1 m by 0.1 m, its end at -0.5 m fixed; 1 Hz and more, 10 kg.
inline std::shared_ptr<const ReducedModel> soft_beam() {
  static const auto model = std::make_shared<const ReducedModel>(*reduce(
      cantilever({{1.0, 0.1, 0.1}, {10, 2, 2}}, {4e5, 0.3, 1000.0}), {5, 10}, "beam", go_on));
  return model;
}

/// What a test says about a scene with one reduced body; make_world() builds it by the registries.
struct ReducedScene {
  std::shared_ptr<const ReducedModel> model = soft_beam();
  ParameterText material;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< world from body
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  std::vector<Obstacle> obstacles;
  std::vector<std::pair<std::string, ParameterText>> effects;  ///< in the registry's order
  std::string solver = "midpoint";
  ParameterText solver_parameters;
  double time_step = 0.002;  ///< [s]
};

inline std::unique_ptr<World> make_world(const ReducedScene& scene) {
  auto world = std::make_unique<World>(scene.time_step);
  for (const Obstacle& obstacle : scene.obstacles) world->add_obstacle(obstacle);
  BodyGeometry geometry;
  geometry.reduced = scene.model;
  geometry.contact_points = scene.model->mesh.vertices;
  const auto& entry = model_registry().find("reduced");
  auto model = entry.make(parse_parameters(entry.parameters, scene.material, "test"), geometry);
  model->place(scene.pose);
  model->set_velocity(scene.velocity);
  Body& body = world->add_body("body", std::move(model));
  for (const auto& [name, parameters] : scene.effects) {
    world->add_effect(body, effect_registry(), name, parameters, "test");
  }
  world->set_solver(body, all_solvers(), scene.solver, scene.solver_parameters, "test");
  world->set_initial_state();
  return world;
}

inline ReducedBodySystem& reduced_of(World& world) {
  return dynamic_cast<ReducedBodySystem&>(body_of(world).model->system());
}

inline std::vector<std::string> reduced_solvers() { return all_solvers().names_for("reduced"); }

/// A beam of one coordinate, its stretch along x: u = (x, 0, 0) q.
inline std::shared_ptr<const ReducedModel> stretching_block(double stiffness) {
  auto model = std::make_shared<ReducedModel>();
  model->name = "block";
  model->material = {1e5, 0.3, 1000.0};
  model->mesh = make_block({{0.4, 0.2, 0.2}, {2, 1, 1}});
  const auto n = model->mesh.vertices.cols();
  model->fixed.assign(static_cast<std::size_t>(n), false);
  model->basis = Eigen::MatrixXd::Zero(3 * n, 1);
  for (Eigen::Index i = 0; i < n; ++i) model->basis(3 * i, 0) = model->mesh.vertices(0, i);
  model->potential = QuarticPotential(Eigen::VectorXd::Constant(1, stiffness), {0.0, 0.0}, "block");
  return model;
}

}  // namespace pliant
