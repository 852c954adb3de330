#pragma once

#include <limits>
#include <string>

#include "support/worlds/worlds.h"

namespace pliant {

/// A cloth that comes down on a ball and a plane, with friction.
inline std::unique_ptr<World> draped_cloth(const std::string& solver,
                                           const ParameterText& parameters) {
  ClothScene scene;
  scene.grid = {0.3, 0.3, 9, 9};
  scene.pose = at(0.02, 0.01, 0.105);
  scene.material = {{"stretch_warp", "50"}, {"stretch_weft", "50"}, {"shear", "5"}};
  scene.obstacles = {obstacle(Sphere(0.1)), obstacle(Plane(), at(0, 0, 0.06))};
  scene.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {{"coefficient", "0.4"}}}};
  scene.solver = solver;
  scene.solver_parameters = parameters;
  return make_world(scene);
}

/// What single precision does to a coordinate in so many iterations that make no error grow: to
/// each displacement that a neighbour asks for, as long as an edge, a few ε [m].
inline double single_round_off(const Positions& x, int iterations) {
  constexpr double kRoundings = 8.0;
  const double size = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
  return kRoundings * std::numeric_limits<float>::epsilon() * size * iterations;
}

}  // namespace pliant
