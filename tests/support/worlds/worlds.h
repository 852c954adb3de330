#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/effects/registry.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/models/registry.h"
#include "support/solvers/solvers.h"

namespace pliant {

/// What a test says about a scene with one grid cloth; make_world() builds it by the registries.
struct ClothScene {
  GridOptions grid{0.3, 0.3, 7, 7};
  ParameterText material;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< world from grid
  std::vector<int> fixed;
  std::vector<Obstacle> obstacles;
  std::vector<std::pair<std::string, ParameterText>> effects;  ///< in the registry's order
  std::string solver = "xpbd";
  ParameterText solver_parameters;
  double time_step = 0.005;  ///< [s]
};

std::unique_ptr<World> make_world(const ClothScene& scene);
/// A soft cloth that falls from `height` [m] onto a sphere and a plane, with gravity, damping, air
/// of these parameters, contact and friction.
ClothScene falling_scene(const std::string& solver, double height, const ParameterText& air);
/// With another geometry than the scene's grid.
std::unique_ptr<World> make_world(const ClothScene& scene, const BodyGeometry& geometry);

/// Stiff enough to look like cloth, soft enough for every solver to converge in few iterations.
inline ParameterText soft_material() {
  return {{"stretch_warp", "10"}, {"stretch_weft", "10"}, {"shear", "1"}, {"bending", "0"}};
}

inline Eigen::Isometry3d at(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

template <class ShapeType>
Obstacle obstacle(const ShapeType& shape, const Eigen::Isometry3d& pose = at(0, 0, 0)) {
  Obstacle obstacle;
  obstacle.name = shape.name();
  obstacle.shape = std::make_shared<ShapeType>(shape);
  obstacle.pose_start = obstacle.pose_end = pose;
  return obstacle;
}

inline Body& body_of(World& world) { return world.bodies().front(); }
inline Particles& particles_of(World& world) { return world.bodies().front().particles(); }

template <class EffectType>
EffectType& effect_of(World& world, const std::string& name) {
  return dynamic_cast<EffectType&>(*body_of(world).find_effect(name));
}

/// Steps until `seconds` are over; fails the test where a step is undone.
void run_for(World& world, double seconds);

/// Row and column of a grid's vertex -> its number.
inline int vertex(const GridOptions& grid, int row, int column) {
  return row * grid.columns + column;
}

/// The vertices of a grid's row.
std::vector<int> row_of(const GridOptions& grid, int row);

}  // namespace pliant
