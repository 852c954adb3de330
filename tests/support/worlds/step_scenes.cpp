#include "support/worlds/step_scenes.h"

#include <map>

#include "support/disturb.h"

namespace pliant {

std::unique_ptr<World> world_at_rest(const StepScene& scene, const std::string& solver,
                                     const ParameterText& parameters) {
  ClothScene cloth = scene.scene;
  cloth.solver = solver;
  cloth.solver_parameters = parameters;
  return scene.mesh ? make_world(cloth, {*scene.mesh, std::nullopt}) : make_world(cloth);
}

const Particles& begin_of_step(const StepScene& scene) {
  static std::map<std::string, Particles> states;
  const auto found = states.find(scene.name);
  if (found != states.end()) return found->second;
  const auto world = world_at_rest(scene, "newton");
  disturb(*world, 0.0, scene.speed);
  for (int k = 0; k < scene.warm_up; ++k) {
    for (int i : scene.scene.fixed) particles_of(*world).x(2, i) += scene.lift;
    EXPECT_TRUE(world->step()) << scene.name;
    EXPECT_TRUE(body_of(*world).report.warnings.empty())
        << scene.name << ": " << body_of(*world).report.warnings[0];
  }
  return states.emplace(scene.name, particles_of(*world)).first->second;
}

std::unique_ptr<World> world_before_step(const StepScene& scene, const std::string& solver,
                                         const ParameterText& parameters) {
  auto world = world_at_rest(scene, solver, parameters);
  particles_of(*world) = begin_of_step(scene);
  return world;
}

StepScene hanging_scene(const std::string& name, int nodes, double dt,
                        const ParameterText& material) {
  StepScene s;
  s.name = name;
  s.scene.grid = {0.3, 0.3, nodes, nodes};
  s.scene.material = material;
  s.scene.time_step = dt;
  s.scene.fixed = corners(s.scene.grid);
  s.scene.effects = {{"gravity", {}}, {"damping", {}}};
  return s;
}

ParameterText fabric(double stretch, double shear, double bending) {
  return {{"stretch_warp", std::to_string(stretch)},
          {"stretch_weft", std::to_string(stretch)},
          {"shear", std::to_string(shear)},
          {"bending", std::to_string(bending)}};
}

TriangleMesh obtuse_mesh(int nodes) {
  TriangleMesh mesh = make_grid({0.2, 0.05, nodes, nodes});
  mesh.vertices.row(0) += 4.0 * mesh.vertices.row(1);
  return mesh;
}

StepScene lying_scene(const std::string& name, const std::vector<std::string>& effects) {
  StepScene s;
  s.name = name;
  s.scene.grid = {0.3, 0.3, 13, 13};
  s.scene.obstacles = {obstacle(Plane()), obstacle(Sphere(0.06), at(0.03, 0.02, 0.0))};
  s.scene.pose = at(0, 0, 0.063);
  s.scene.effects = {{"gravity", {}}, {"damping", {}}};
  for (const std::string& effect : effects) s.scene.effects.push_back({effect, {}});
  s.warm_up = 30;
  return s;
}

StepScene tent_scene() {
  StepScene s;
  s.name = "contact_friction_and_air";
  s.scene.grid = {0.3, 0.3, 13, 13};
  s.scene.obstacles = {obstacle(Plane())};
  s.scene.pose = at(0, 0, 0.001);
  s.scene.fixed = {vertex(s.scene.grid, 6, 6)};
  s.scene.effects = {{"gravity", {}},
                     {"damping", {}},
                     {"air", {{"volume", "1e-5"}, {"seal_breaks", "false"}}},
                     {"contact", {}},
                     {"friction", {}}};
  s.speed = 0.0;
  s.warm_up = 20;
  s.lift = 5e-4;
  return s;
}

const std::vector<StepScene>& step_scenes() {
  static const std::vector<StepScene> scenes = [] {
    std::vector<StepScene> all;
    all.push_back(hanging_scene("soft_coarse", 7, 0.005, soft_material()));
    all.push_back(hanging_scene("default_coarse", 11, 0.005, {}));
    all.push_back(hanging_scene("default_fine", 41, 0.005, {}));
    all.push_back(hanging_scene("stiff_coarse", 9, 0.01, fabric(2e4, 2e3, 1e-4)));
    all.push_back(hanging_scene("stiff_fine", 31, 1.0 / 60, fabric(1e4, 1e3, 1e-4)));
    all.push_back(hanging_scene("stiff_bending", 15, 0.01, fabric(500, 50, 1e-2)));
    all.push_back(hanging_scene("large_step", 11, 0.1, {}));
    all.push_back(hanging_scene("stretch_beside_shear", 11, 0.01, fabric(5e3, 5, 0)));
    StepScene slivers = hanging_scene("slivers", 13, 0.005, fabric(500, 50, 1e-6));
    slivers.scene.grid.height = 0.015;
    all.push_back(slivers);
    StepScene obtuse = hanging_scene("obtuse", 11, 0.005, fabric(500, 50, 1e-5));
    obtuse.mesh = obtuse_mesh(11);
    all.push_back(obtuse);
    all.push_back(lying_scene("contact", {"contact"}));
    all.push_back(lying_scene("contact_and_friction", {"contact", "friction"}));
    return all;
  }();
  return scenes;
}

}  // namespace pliant
