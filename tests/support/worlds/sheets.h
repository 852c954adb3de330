#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/models/registry.h"
#include "support/worlds/worlds.h"

namespace pliant {

/// A flat disc about the origin of rings of `sectors` vertices, its normals +z.
inline TriangleMesh disc(double radius, int rings, int sectors) {
  TriangleMesh mesh{Eigen::Matrix3Xd::Zero(3, rings * sectors + 1),
                    Eigen::Matrix3Xi(3, sectors * (2 * rings - 1))};
  const auto at = [&](int ring, int k) { return 1 + (ring - 1) * sectors + k % sectors; };
  int t = 0;
  for (int r = 1; r <= rings; ++r) {
    for (int k = 0; k < sectors; ++k) {
      const double angle = 2.0 * M_PI * k / sectors;
      mesh.vertices.col(at(r, k)) << std::cos(angle), std::sin(angle), 0.0;
      mesh.vertices.col(at(r, k)) *= radius * r / rings;
      if (r == 1) {
        mesh.triangles.col(t++) << 0, at(1, k), at(1, k + 1);
      } else {
        mesh.triangles.col(t++) << at(r - 1, k), at(r, k), at(r, k + 1);
        mesh.triangles.col(t++) << at(r - 1, k), at(r, k + 1), at(r - 1, k + 1);
      }
    }
  }
  return mesh;
}

/// A world with one cloth of any mesh.
inline std::unique_ptr<World> sheet_world(
    const TriangleMesh& mesh, const std::vector<Obstacle>& obstacles,
    const std::vector<std::pair<std::string, ParameterText>>& effects, double dt,
    const ParameterText& material = {}) {
  auto world = std::make_unique<World>(dt);
  for (const Obstacle& obstacle : obstacles) world->add_obstacle(obstacle);
  const auto& entry = model_registry().find("cloth");
  Body& body = world->add_body(
      "cloth", entry.make(parse_parameters(entry.parameters, material, "test"), {mesh, {}}));
  for (const auto& [name, parameters] : effects) {
    world->add_effect(body, effect_registry(), name, parameters, "test");
  }
  world->set_solver(body, solver_registry(), "xpbd", {}, "test");
  world->set_initial_state();
  return world;
}

/// Fixes all vertices: the test moves them.
inline void make_rigid(World& world) {
  for (int i = 0; i < particles_of(world).size(); ++i) particles_of(world).fix(i);
  world.system_changed();
  world.set_initial_state();
}

}  // namespace pliant
