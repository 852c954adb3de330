#include "pliant/geometry/search/normal_cones.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "pliant/geometry/distance/closest_point.h"
#include "pliant/geometry/search/box_tree.h"

namespace pliant {
namespace {

// Faces whose normals differ by less lie in one plane.
constexpr double kFlat = 1e-6;
// Of the surface's size: what is so near to a point is at it.
constexpr double kAt = 1e-9;
// Points at which more faces come together are ends of fans, round as far as is known.
constexpr std::size_t kMostFaces = 8;

Eigen::Vector3d corner(const TriangleMesh& mesh, int triangle, int k) {
  return mesh.vertices.col(mesh.triangles(k, triangle));
}

Eigen::Vector3d normal_of(const TriangleMesh& mesh, int triangle) {
  const Eigen::Vector3d a = corner(mesh, triangle, 0);
  return (corner(mesh, triangle, 1) - a).cross(corner(mesh, triangle, 2) - a).normalized();
}

/// The edges at which the surface bends, as triangles of two corners.
TriangleMesh bent_edges(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, std::vector<int>> sides;
  for (int t = 0; t < static_cast<int>(mesh.triangles.cols()); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles(k, t), b = mesh.triangles((k + 1) % 3, t);
      sides[{std::min(a, b), std::max(a, b)}].push_back(t);
    }
  }
  std::vector<Eigen::Vector3i> bent;
  for (const auto& [ends, of] : sides) {
    const bool is_flat =
        of.size() == 2 && (normal_of(mesh, of[0]) - normal_of(mesh, of[1])).norm() < kFlat;
    if (!is_flat) bent.emplace_back(ends.first, ends.second, ends.second);
  }
  TriangleMesh edges;
  edges.vertices = mesh.vertices;
  edges.triangles.resize(3, static_cast<Eigen::Index>(bent.size()));
  for (std::size_t e = 0; e < bent.size(); ++e) {
    edges.triangles.col(static_cast<Eigen::Index>(e)) = bent[e];
  }
  return edges;
}

double distance(const TriangleMesh& mesh, int triangle, const Eigen::Vector3d& p) {
  return (closest_point_on_triangle(p, corner(mesh, triangle, 0), corner(mesh, triangle, 1),
                                    corner(mesh, triangle, 2)) -
          p)
      .norm();
}

/// What Eigen's BVIntersect asks for: the triangles at a point.
struct AtPoint {
  const TriangleMesh& mesh;
  const Eigen::Vector3d& p;
  double near;
  std::vector<int> found = {};

  bool intersectVolume(const Eigen::AlignedBox3d& box) const {
    return box.squaredExteriorDistance(p) <= near * near;
  }
  bool intersectObject(int triangle) {
    if (distance(mesh, triangle, p) <= near) found.push_back(triangle);
    return false;
  }
};

/// What its BVMinimize asks for: the distance of the nearest triangle that is not at the point.
struct BesidePoint {
  using Scalar = double;
  const TriangleMesh& mesh;
  const Eigen::Vector3d& p;
  double near;

  double minimumOnVolume(const Eigen::AlignedBox3d& box) const { return box.exteriorDistance(p); }
  double minimumOnObject(int triangle) const {
    const double away = distance(mesh, triangle, p);
    return away > near ? away : std::numeric_limits<double>::max();
  }
};

/// The normals of the faces at a point; none where these are not convex, or too many.
std::vector<Eigen::Vector3d> normals_at(const TriangleMesh& mesh, const std::vector<int>& triangles,
                                        const Eigen::Vector3d& p, double near) {
  std::vector<Eigen::Vector3d> normals;
  for (const int t : triangles) {
    const Eigen::Vector3d normal = normal_of(mesh, t);
    const auto is_same = [&](const Eigen::Vector3d& other) {
      return (other - normal).norm() < kFlat;
    };
    if (std::none_of(normals.begin(), normals.end(), is_same)) normals.push_back(normal);
  }
  if (normals.size() > kMostFaces) return {};
  for (const int t : triangles) {
    for (int k = 0; k < 3; ++k) {
      for (const Eigen::Vector3d& normal : normals) {
        if (normal.dot(corner(mesh, t, k) - p) > near) return {};
      }
    }
  }
  return normals;
}

}  // namespace

NormalCones::NormalCones(const TriangleMesh& surface, const Eigen::Matrix3Xd& points)
    : begins_{0}, reach_(Eigen::VectorXd::Zero(points.cols())) {
  const Eigen::Vector3d size =
      surface.vertices.rowwise().maxCoeff() - surface.vertices.rowwise().minCoeff();
  const double near = kAt * size.norm();
  const TriangleMesh edges = bent_edges(surface);
  const BoxTree faces = make_box_tree(surface), bends = make_box_tree(edges);
  std::vector<Eigen::Vector3d> all;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d p = points.col(i);
    AtPoint at{surface, p, near};
    Eigen::BVIntersect(faces, at);
    const std::vector<Eigen::Vector3d> normals = normals_at(surface, at.found, p, near);
    if (!normals.empty()) {
      BesidePoint beside{edges, p, near};
      reach_[i] = Eigen::BVMinimize(bends, beside);
    }
    all.insert(all.end(), normals.begin(), normals.end());
    begins_.push_back(static_cast<int>(all.size()));
  }
  normals_.resize(3, static_cast<Eigen::Index>(all.size()));
  for (std::size_t k = 0; k < all.size(); ++k) normals_.col(static_cast<Eigen::Index>(k)) = all[k];
}

Eigen::Vector3d NormalCones::part_within(int point, const Eigen::Vector3d& direction) const {
  const int begin = begins_[static_cast<std::size_t>(point)];
  const int end = begins_[static_cast<std::size_t>(point) + 1];
  // The longest of the parts along faces, edges and corners of the cone.
  Eigen::Vector3d part = Eigen::Vector3d::Zero();
  const auto take = [&](const Eigen::Vector3d& other) {
    if (other.squaredNorm() > part.squaredNorm()) part = other;
  };
  for (int a = begin; a < end; ++a) {
    const Eigen::Vector3d na = normals_.col(a);
    if (na.dot(direction) > 0.0) take(na.dot(direction) * na);
    for (int b = a + 1; b < end; ++b) {
      const Eigen::Vector3d nb = normals_.col(b);
      const double cosine = na.dot(nb), along_a = na.dot(direction), along_b = nb.dot(direction);
      const double squared_sine = 1.0 - cosine * cosine;
      if (!(squared_sine > kFlat * kFlat)) continue;
      const double share_a = (along_a - cosine * along_b) / squared_sine;
      const double share_b = (along_b - cosine * along_a) / squared_sine;
      if (share_a >= 0.0 && share_b >= 0.0) take(share_a * na + share_b * nb);
      for (int c = b + 1; c < end; ++c) {
        Eigen::Matrix3d corners;
        corners << na, nb, normals_.col(c);
        if (std::abs(corners.determinant()) < kFlat) continue;
        if ((corners.inverse() * direction).minCoeff() >= 0.0) return direction;
      }
    }
  }
  return part;
}

}  // namespace pliant
