#include "pliant/geometry/meshing/surface_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pliant/geometry/meshing/spaced_points.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

double longest_edge(const TriangleMesh& mesh, Eigen::Index triangle) {
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    longest = std::max(longest, (mesh.vertices.col(mesh.triangles(k, triangle)) -
                                 mesh.vertices.col(mesh.triangles((k + 1) % 3, triangle)))
                                    .norm());
  }
  return longest;
}

void check_spacing(const TriangleMesh& mesh, double spacing) {
  if (!std::isfinite(spacing) || spacing <= 0.0) {
    throw InputError(
        fmt::format("spacing of contact points is {} m, but must be positive and finite", spacing));
  }
  double points = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    points += std::pow(std::ceil(longest_edge(mesh, t) / (kSampleGrid * spacing)), 2.0);
  }
  if (points > kMaxTriangles) {
    throw InputError(
        fmt::format("a spacing of {:g} m makes {:.3g} contact points, but at most {} are allowed: "
                    "take a contact_spacing of about {:.2g} m or more",
                    spacing, points, kMaxTriangles, spacing * std::sqrt(points / kMaxTriangles)));
  }
}

}  // namespace

Eigen::Matrix3Xd sample_surface(const TriangleMesh& mesh, double spacing) {
  check_spacing(mesh, spacing);
  SpacedPoints spaced(kSampleDistance * spacing);
  std::vector<Vector3d> points;
  const auto add = [&](const Vector3d& p) {
    if (spaced.keep(p)) points.push_back(p);
  };
  for (const auto vertex : mesh.vertices.colwise()) add(vertex);
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) { return mesh.vertices.col(mesh.triangles(k, t)); };
    const int parts = static_cast<int>(std::ceil(longest_edge(mesh, t) / (kSampleGrid * spacing)));
    for (int i = 0; i <= parts; ++i) {
      for (int j = 0; i + j <= parts; ++j) {
        add((i * corner(0) + j * corner(1) + (parts - i - j) * corner(2)) / parts);
      }
    }
  }
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) {
    result.col(static_cast<Eigen::Index>(k)) = points[k];
  }
  return result;
}

double mean_edge_length(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      sum += (mesh.vertices.col(mesh.triangles(k, t)) -
              mesh.vertices.col(mesh.triangles((k + 1) % 3, t)))
                 .norm();
    }
  }
  return sum / (3.0 * static_cast<double>(std::max<Eigen::Index>(1, mesh.triangles.cols())));
}

}  // namespace pliant
