#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/scene/geometry_kinds.h"
#include "support/worlds.h"

namespace pliant {

/// What a test says about a scene with one body of the model `patch`.
struct PatchScene {
  std::string kind = "sphere";
  ParameterText size = {{"radius", "0.05"}};
  ParameterText options = {{"tetrahedra", "600"}};
  ParameterText material = {{"young", "2e4"}, {"poisson", "0.3"}, {"density", "500"}};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< world from body
  std::vector<Obstacle> obstacles;
  std::vector<std::pair<std::string, ParameterText>> effects;  ///< in the registry's order
  std::string solver = "newton";
  ParameterText solver_parameters;
  double time_step = 0.01;  ///< [s]
};

inline BodyGeometry make_patch_geometry(const PatchScene& scene) {
  const GeometryKind& kind = find_geometry_kind(scene.kind, "patch");
  return kind.make("", parse_parameters(kind.size, scene.size, "size"),
                   parse_parameters(kind.options, scene.options, "options"));
}

inline std::unique_ptr<Model> make_patch_model(const PatchScene& scene) {
  const auto& entry = model_registry().find("patch");
  return entry.make(parse_parameters(entry.parameters, scene.material, "material"),
                    make_patch_geometry(scene));
}

inline std::unique_ptr<World> make_world(const PatchScene& scene) {
  auto world = std::make_unique<World>(scene.time_step);
  for (const Obstacle& obstacle : scene.obstacles) world->add_obstacle(obstacle);
  Body& body = world->add_body("body", make_patch_model(scene));
  Particles& particles = body.particles();
  particles.x = (scene.pose.linear() * particles.x).colwise() + scene.pose.translation();
  particles.x_start = particles.x;
  for (const auto& [name, parameters] : scene.effects) {
    world->add_effect(body, effect_registry(), name, parameters, "test");
  }
  world->set_solver(body, solver_registry(), scene.solver, scene.solver_parameters, "test");
  world->set_initial_state();
  return world;
}

}  // namespace pliant
