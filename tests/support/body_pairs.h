#pragma once

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "pliant/scene/scene.h"
#include "support/intersections.h"
#include "unit/scene/scene_files.h"

namespace pliant {

/// A body of 0.1 x 0.1 x 0.05 m (cloth: 0.1 x 0.1 m) as a scene file lists it, its middle at `z`.
inline std::string slab(const std::string& name, const std::string& model, double z,
                        const std::string& more = "") {
  const std::string geometry =
      model == "cloth"   ? "{grid: {size: [0.1, 0.1], vertices: [9, 9]}}"
      : model == "patch" ? "{block: {size: [0.1, 0.1, 0.05], cells: [4, 4, 2]}}"
      : model == "rigid" ? "{box: {size: [0.1, 0.1, 0.05]}}"
                         : "{block: {size: [0.1, 0.1, 0.05]}, particles: 400}";
  const std::string material = model == "patch"   ? "{young: 1.0e+5, density: 500}"
                               : model == "rigid" ? "{density: 500}"
                               : model == "cloth" ? "{areal_density: 0.3}"
                                                  : "{state: elastic, density: 500}";
  return fmt::format(
      "  - {{name: {}, model: {}, geometry: {}, material: {}, position: [0, 0, {}]{}}}\n", name,
      model, geometry, material, z, more.empty() ? "" : ", " + more);
}

/// Effects in the notation of a scene file, one a line, indented.
inline std::string scene_text(const std::vector<std::string>& bodies, const std::string& effects,
                              const std::string& more = "") {
  std::string text = "time_step: 0.005\nbodies:\n";
  for (const std::string& body : bodies) text += body;
  return text + "effects:\n" + effects + more;
}

inline std::unique_ptr<World> world_of(const std::string& text) {
  const SceneFiles files;
  return std::move(load_scene(files.write("scene.yaml", text)).world);
}

inline Body& body_named(World& world, const std::string& name) {
  for (Body& body : world.bodies()) {
    if (body.name == name) return body;
  }
  throw std::runtime_error("no body '" + name + "'");
}

/// Of the other bodies' contact on it in the last step [N].
inline Eigen::Vector3d contact_force_on(World& world, const std::string& name) {
  return body_named(world, name).model->system().forces_of_bodies.rowwise().sum();
}

inline double mass_of(World& world, const std::string& name) {
  return body_named(world, name).particles().mass.sum();
}

inline Eigen::Vector3d momentum_of(const World& world) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Body& body : world.bodies()) sum += body.particles().momentum();
  return sum;
}

/// How many edges of one body pass through triangles of another.
inline int intersections_between(const World& world) {
  Eigen::Matrix3Xd vertices(3, 0);
  Eigen::Matrix3Xi triangles(3, 0);
  int within = 0;  // bodies themselves
  for (const Body& body : world.bodies()) {
    const TriangleMesh mesh = body.model->surface();
    within += count_intersections(mesh.vertices, mesh.triangles);
    const auto first = static_cast<int>(vertices.cols());
    vertices.conservativeResize(3, first + mesh.vertices.cols());
    vertices.rightCols(mesh.vertices.cols()) = mesh.vertices;
    triangles.conservativeResize(3, triangles.cols() + mesh.triangles.cols());
    triangles.rightCols(mesh.triangles.cols()) = mesh.triangles.array() + first;
  }
  return count_intersections(vertices, triangles) - within;
}

}  // namespace pliant
