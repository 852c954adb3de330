#pragma once

#include <cmath>
#include <vector>

#include "pliant/geometry/patch/patch_surface.h"
#include "support/random.h"
#include "support/worlds/surfaces.h"

namespace pliant {

/// steepness³ (1 - |p|²)³ / 8 on the edges of a base with vertices on the unit sphere.
inline PatchBody sphere_patches(const TriangleMesh& base, double steepness) {
  PatchBody body;
  body.base = base;
  body.edges = edges(base).vertices;
  Quadric q = Quadric::Zero();
  q.head<3>().setConstant(-0.5 * steepness);
  q[9] = 0.5 * steepness;
  body.quadrics.assign(body.edges.size(), q);
  return body;
}

/// Three triangles about a vertex, bulging by other quadrics on each edge, zero at its ends.
inline PatchBody three_patches() {
  PatchBody body;
  body.base.vertices.resize(3, 4);
  body.base.vertices << 0, 1, -0.5, -0.5,  //
      0, 0, 0.9, -0.9,                     //
      0.4, 0, 0, 0;
  body.base.triangles.resize(3, 3);
  body.base.triangles << 0, 0, 0,  //
      1, 2, 3,                     //
      2, 3, 1;
  body.edges = edges(body.base).vertices;
  for (std::size_t e = 0; e < body.edges.size(); ++e) {
    const Eigen::Vector3d a = body.base.vertices.col(body.edges[e][0]);
    const Eigen::Vector3d b = body.base.vertices.col(body.edges[e][1]);
    const double height = 1.0 + 0.2 * static_cast<double>(e);
    // height (1 - |p - middle|² / r²): zero at both ends.
    const Eigen::Vector3d middle = 0.5 * (a + b);
    const double r = 0.5 * (a - b).norm();
    Quadric q = Quadric::Zero();
    q.head<3>().setConstant(-height);
    q[9] = height;
    body.quadrics.push_back(placed(q, middle, r));
  }
  return body;
}

}  // namespace pliant
