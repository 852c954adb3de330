#pragma once

#include <optional>
#include <string>
#include <vector>

#include "support/worlds/worlds.h"

namespace pliant {

/// A cloth in motion, at the beginning of a step that solvers are compared on.
struct StepScene {
  std::string name;
  ClothScene scene;
  std::optional<TriangleMesh> mesh;  ///< in place of the scene's grid
  double speed = 0.3;                ///< of random motion at the start [m/s]
  int warm_up = 5;                   ///< converged steps before that step
  double lift = 0.0;                 ///< of the fixed vertices in each of them [m]
};

inline std::ostream& operator<<(std::ostream& out, const StepScene& scene) {
  return out << scene.name;
}

/// The scene as it begins, with another solver.
std::unique_ptr<World> world_at_rest(const StepScene& scene, const std::string& solver,
                                     const ParameterText& parameters = {});

/// The state at the beginning of the step; made once a scene.
const Particles& begin_of_step(const StepScene& scene);

/// The scene at the beginning of the step.
std::unique_ptr<World> world_before_step(const StepScene& scene, const std::string& solver,
                                         const ParameterText& parameters = {});

inline std::vector<int> corners(const GridOptions& grid) {
  return {vertex(grid, grid.rows - 1, 0), vertex(grid, grid.rows - 1, grid.columns - 1)};
}

StepScene hanging_scene(const std::string& name, int nodes, double dt,
                        const ParameterText& material);

ParameterText fabric(double stretch, double shear, double bending);

/// A strip of obtuse triangles: a grid sheared by four times its height.
TriangleMesh obtuse_mesh(int nodes);

StepScene lying_scene(const std::string& name, const std::vector<std::string>& effects);

/// A cloth sealed to a plane and lifted by its middle, with contact, friction and air.
StepScene tent_scene();

/// Soft to stiff, coarse to fine, slivers, with contact.
const std::vector<StepScene>& step_scenes();

}  // namespace pliant
