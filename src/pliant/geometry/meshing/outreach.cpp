#include "pliant/geometry/meshing/outreach.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pliant/geometry/distance/barycentric.h"
#include "pliant/geometry/distance/closest_point.h"
#include "pliant/geometry/mesh/tetrahedron_faces.h"
#include "pliant/geometry/meshing/embedding.h"

namespace pliant {
namespace {

using Triangle = Eigen::Matrix3d;  // a corner each column

constexpr int kMostSplits = 6;

double distance(const Eigen::Matrix<double, 3, 4>& tetrahedron, const Eigen::Vector3d& p) {
  if (Barycentric(tetrahedron)(p).minCoeff() >= 0.0) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (int f = 0; f < 4; ++f) {
    const Eigen::Vector3i v = face_vertices({0, 1, 2, 3}, f);
    const Eigen::Vector3d nearest = closest_point_on_triangle(
        p, tetrahedron.col(v[0]), tetrahedron.col(v[1]), tetrahedron.col(v[2]));
    least = std::min(least, (nearest - p).norm());
  }
  return least;
}

double radius(const Triangle& t) {
  const Eigen::Vector3d middle = t.rowwise().mean();
  return std::sqrt((t.colwise() - middle).colwise().squaredNorm().maxCoeff());
}

void split(const Triangle& t, std::vector<Triangle>& parts) {
  Triangle middles;  // of the side behind each corner
  for (int c = 0; c < 3; ++c) middles.col(c) = 0.5 * (t.col((c + 1) % 3) + t.col((c + 2) % 3));
  parts.push_back(middles);
  for (int c = 0; c < 3; ++c) {
    Triangle part = middles;
    part.col(c) = t.col(c);
    parts.push_back(part);
  }
}

Eigen::Matrix3Xd middles_of(const std::vector<Triangle>& triangles) {
  Eigen::Matrix3Xd middles(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    middles.col(static_cast<Eigen::Index>(t)) = triangles[t].rowwise().mean();
  }
  return middles;
}

}  // namespace

double outreach(const TriangleMesh& surface, const TetrahedralMesh& mesh, double tolerance,
                const std::string& where) {
  std::vector<Triangle> looked_at, parts;
  for (const auto t : surface.triangles.colwise()) {
    Triangle corners;
    for (int c = 0; c < 3; ++c) corners.col(c) = surface.vertices.col(t[c]);
    looked_at.push_back(corners);
  }
  // Of what was looked at: what it reaches, and what it can reach at most.
  double reached = 0.0, most = 0.0;
  for (int splits = 0; !looked_at.empty(); ++splits) {
    const Eigen::Matrix3Xd middles = middles_of(looked_at);
    const Embedding embedding = embed(middles, mesh, where);
    parts.clear();
    for (std::size_t k = 0; k < looked_at.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      const Eigen::Matrix<double, 3, 4> tetrahedron =
          corners_of(mesh.vertices, mesh.tetrahedra.col(embedding.tetrahedron[at]));
      reached = std::max(reached, distance(tetrahedron, middles.col(at)));
      // The distance from a tetrahedron, which is convex, is largest at a corner.
      double bound = 0.0;
      for (int c = 0; c < 3; ++c) {
        bound = std::max(bound, distance(tetrahedron, looked_at[k].col(c)));
      }
      const bool is_small = bound <= std::max(reached, tolerance);
      if (is_small || splits == kMostSplits || radius(looked_at[k]) <= tolerance) {
        most = std::max(most, bound);
      } else {
        split(looked_at[k], parts);
      }
    }
    looked_at.swap(parts);
  }
  return std::max(reached, most);
}

}  // namespace pliant
