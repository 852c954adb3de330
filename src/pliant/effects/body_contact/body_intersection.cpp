#include "pliant/effects/body_contact/body_intersection.h"

#include <Eigen/Geometry>

#include "pliant/geometry/search/box_hierarchy.h"

namespace pliant {
namespace {

using Bounds = BoxHierarchy::Box;

/// Six times the volume of a tetrahedron, with a sign.
double volume(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
              const Eigen::Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Where the segment from p to q passes through the inside of a triangle.
std::optional<Eigen::Vector3d> passage(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                                       const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                       const Eigen::Vector3d& c) {
  const double below = volume(a, b, c, p), above = volume(a, b, c, q);
  if (below * above >= 0.0) return std::nullopt;
  const double u = volume(p, q, a, b), v = volume(p, q, b, c), w = volume(p, q, c, a);
  const bool is_within = (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
  if (!is_within) return std::nullopt;
  return p + below / (below - above) * (q - p);
}

}  // namespace

std::optional<BodyIntersection> find_intersection(const BodySurfaces& surfaces,
                                                  const Positions& vertices,
                                                  const BodyPairTable& pairs) {
  const Eigen::Matrix3Xi& triangles = surfaces.triangles();
  std::vector<Bounds> boxes;
  for (const auto t : triangles.colwise()) {
    Bounds box;
    for (int k = 0; k < 3; ++k) box.extend(Eigen::Vector3d(vertices.col(t[k])));
    boxes.push_back(box);
  }
  if (boxes.empty()) return std::nullopt;
  BoxHierarchy tree;
  tree.build(boxes);
  std::optional<BodyIntersection> found;
  const auto body_of = [&](int vertex) {
    return surfaces.bodies()[static_cast<std::size_t>(vertex)];
  };
  for (const auto own : triangles.colwise()) {
    for (int k = 0; k < 3 && !found; ++k) {
      const int i = own[k], j = own[(k + 1) % 3];
      const Eigen::Vector3d p = vertices.col(i), q = vertices.col(j);
      Bounds box(p);
      box.extend(q);
      tree.for_each_overlapping(box, [&](int other) {
        const auto t = triangles.col(other);
        if (found || !pairs.touches(body_of(t[0]), body_of(i))) return;
        const auto place =
            passage(p, q, vertices.col(t[0]), vertices.col(t[1]), vertices.col(t[2]));
        if (place) found = BodyIntersection{body_of(i), body_of(t[0]), *place};
      });
    }
    if (found) break;
  }
  return found;
}

}  // namespace pliant
