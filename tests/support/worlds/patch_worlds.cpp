#include "support/worlds/patch_worlds.h"

#include "pliant/scene/reading/geometry_kinds.h"

namespace pliant {

BodyGeometry make_patch_geometry(const PatchScene& scene) {
  const GeometryKind& kind = find_geometry_kind(scene.kind, "patch");
  return kind.make("", parse_parameters(kind.size, scene.size, "size"),
                   parse_parameters(kind.options, scene.options, "options"));
}

std::unique_ptr<Model> make_patch_model(const PatchScene& scene) {
  const auto& entry = model_registry().find("patch");
  return entry.make(parse_parameters(entry.parameters, scene.material, "material"),
                    make_patch_geometry(scene));
}

std::unique_ptr<World> make_world(const PatchScene& scene) {
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

PatchScene falling_block(const std::string& solver, const ParameterText& parameters) {
  PatchScene scene;
  scene.kind = "block";
  scene.size = {{"size", "[0.1, 0.1, 0.1]"}, {"cells", "[3, 3, 3]"}};
  scene.options = {{"contact_spacing", "0.05"}};
  scene.material = {{"young", "1e4"}, {"poisson", "0.3"}, {"density", "500"}};
  scene.pose = at(0, 0, 0.0501) * Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 2, 0).normalized());
  scene.obstacles = {obstacle(Plane())};
  scene.effects = {{"gravity", {}}, {"contact", {{"thickness", "1e-4"}}}};
  scene.solver = solver;
  scene.solver_parameters = parameters;
  return scene;
}

PatchScene falling_ball(const std::string& solver, const ParameterText& parameters) {
  PatchScene scene;
  scene.pose = at(0, 0, 0.0501);
  scene.obstacles = {obstacle(Plane())};
  scene.effects = {{"gravity", {}}, {"contact", {{"thickness", "1e-4"}}}, {"friction", {}}};
  scene.solver = solver;
  scene.solver_parameters = parameters;
  return scene;
}

}  // namespace pliant
