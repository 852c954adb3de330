#pragma once

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pliant/math/error.h"
#include "pliant/math/pi.h"
#include "pliant/scene/scene.h"
#include "support/meshes/intersections.h"
#include "unit/scene/scene_files.h"

namespace pliant {

/// A body of 0.1 x 0.1 x 0.05 m (cloth: 0.1 x 0.1 m) as a scene file lists it, its middle at `z`.
inline std::string slab(const std::string& name, const std::string& model, double z,
                        const std::string& more = "") {
  const std::string geometry =
      model == "cloth"   ? "{grid: {size: [0.1, 0.1], vertices: [9, 9]}}"
      : model == "patch" ? "{block: {size: [0.1, 0.1, 0.05], cells: [4, 4, 2]}}"
      : model == "rigid" ? "{box: {size: [0.1, 0.1, 0.05]}}"
                         : "{block: {size: [0.1, 0.1, 0.05]}, particles: 200}";
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

/// Why a scene is refused; empty: it is not.
inline std::string refusal(const std::string& text) {
  try {
    world_of(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A force that takes all bodies farther in a step than scenes allow.
inline void throw_away(World& world) {
  AppliedForce force;
  force.point = {0, 0, 0.05};
  force.radius = 1.0;
  force.force = {0, 0, 1e5};
  force.duration = 1.0;
  world.applied_forces().add(force);
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

/// By the solid angles of all triangles of a closed surface.
inline bool is_within(const TriangleMesh& solid, const Eigen::Vector3d& p) {
  double angle = 0.0;
  for (const auto t : solid.triangles.colwise()) {
    const Eigen::Vector3d a = solid.vertices.col(t[0]) - p, b = solid.vertices.col(t[1]) - p,
                          c = solid.vertices.col(t[2]) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                              la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle > 2.0 * kPi;
}

inline int count_within(const TriangleMesh& solid, const Positions& points) {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(solid.vertices.rowwise().minCoeff()),
                                Eigen::Vector3d(solid.vertices.rowwise().maxCoeff()));
  int count = 0;
  for (const auto p : points.colwise()) {
    count += box.contains(Eigen::Vector3d(p)) && is_within(solid, p);
  }
  return count;
}

/// How many edges of one body pass through triangles of another, and how many particles of bodies
/// of particles are within solid ones; but for pairs that are left out.
inline int intersections_between(const World& world) {
  int count = 0;
  for (const Body& a : world.bodies()) {
    for (const Body& b : world.bodies()) {
      if (&a == &b || world.body_pairs().is_left_out(a, b)) continue;
      const bool has_balls = a.model->ball_volumes() || b.model->ball_volumes();
      if (!has_balls) count += count_passages(a.model->surface(), b.model->surface());
      if (a.model->ball_volumes() && b.model->is_solid()) {
        count += count_within(b.model->surface(), a.particles().x);
      }
    }
  }
  return count;
}

}  // namespace pliant
