#include "support/worlds/worlds.h"

#include "pliant/effects/registry.h"
#include "pliant/models/registry.h"

namespace pliant {

std::unique_ptr<World> make_world(const ClothScene& scene) {
  BodyGeometry geometry{make_grid(scene.grid), scene.grid};
  geometry.mesh.vertices = scene.pose * geometry.mesh.vertices;
  return make_world(scene, geometry);
}

std::unique_ptr<World> make_world(const ClothScene& scene, const BodyGeometry& geometry) {
  auto world = std::make_unique<World>(scene.time_step);
  for (const Obstacle& obstacle : scene.obstacles) world->add_obstacle(obstacle);
  const auto& entry = model_registry().find("cloth");
  Body& body = world->add_body(
      "cloth", entry.make(parse_parameters(entry.parameters, scene.material, "test"), geometry));
  for (const auto& [name, parameters] : scene.effects) {
    world->add_effect(body, effect_registry(), name, parameters, "test");
  }
  for (int i : scene.fixed) body.particles().fix(i);
  world->set_solver(body, solver_registry(), scene.solver, scene.solver_parameters, "test");
  world->set_initial_state();
  return world;
}

ClothScene falling_scene(const std::string& solver, double height, const ParameterText& air) {
  ClothScene scene;
  scene.material = soft_material();
  scene.pose = at(0, 0, height);
  scene.solver = solver;
  scene.time_step = 1e-3;
  scene.obstacles = {obstacle(Plane()), obstacle(Sphere(0.04))};
  scene.effects = {
      {"gravity", {}}, {"damping", {}}, {"air", air}, {"contact", {}}, {"friction", {}}};
  return scene;
}

void run_for(World& world, double seconds) {
  const double end = world.time() + seconds - 0.5 * world.time_step();
  while (world.time() < end) {
    if (!world.step()) {
      ADD_FAILURE() << body_of(world).report.failure;
      return;
    }
  }
}

std::vector<int> row_of(const GridOptions& grid, int row) {
  std::vector<int> vertices;
  for (int c = 0; c < grid.columns; ++c) vertices.push_back(vertex(grid, row, c));
  return vertices;
}

}  // namespace pliant
