#include "pliant/geometry/mesh/triangle_mesh.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"

namespace pliant {
namespace {

// Normal whose length is twice the triangle's area.
Eigen::Vector3d area_normal(const TriangleMesh& mesh, Eigen::Index triangle) {
  const Eigen::Vector3i t = mesh.triangles.col(triangle);
  const Eigen::Vector3d a = mesh.vertices.col(t[0]);
  return (mesh.vertices.col(t[1]) - a).cross(mesh.vertices.col(t[2]) - a);
}

struct HalfEdge {
  int from;  // the smaller vertex
  int to;
  int opposite;
  int triangle;
};

std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
  std::vector<HalfEdge> sides;
  sides.reserve(3 * mesh.triangles.cols());
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles((k + 1) % 3, t);
      const int b = mesh.triangles((k + 2) % 3, t);
      sides.push_back({std::min(a, b), std::max(a, b), mesh.triangles(k, t), t});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const HalfEdge& l, const HalfEdge& r) {
    if (l.from != r.from) return l.from < r.from;
    if (l.to != r.to) return l.to < r.to;
    return l.triangle < r.triangle;
  });
  return sides;
}

Eigen::Vector3d voronoi_shares(const TriangleMesh& mesh, Eigen::Index t) {
  Eigen::Vector3d cosines;   // times the lengths of both sides
  Eigen::Vector3d opposite;  // squared lengths of the sides
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d corner = mesh.vertices.col(mesh.triangles(k, t));
    const Eigen::Vector3d a = mesh.vertices.col(mesh.triangles((k + 1) % 3, t)) - corner;
    const Eigen::Vector3d b = mesh.vertices.col(mesh.triangles((k + 2) % 3, t)) - corner;
    cosines[k] = a.dot(b);
    opposite[k] = (b - a).squaredNorm();
  }
  for (int k = 0; k < 3; ++k) {
    if (cosines[k] > 0.0) continue;
    Eigen::Vector3d shares = Eigen::Vector3d::Constant(0.25);
    shares[k] = 0.5;
    return shares;
  }
  // A side of length l with the circumcentre has the area l² cot(opposite angle)/4, half for each
  // of its ends, and such a cotangent is `cosines` over twice the triangle's area: so the three
  // areas are in proportion to these products.
  const Eigen::Vector3d sides = opposite.cwiseProduct(cosines) / opposite.dot(cosines);
  return 0.5 * (Eigen::Vector3d::Ones() - sides);
}

}  // namespace

double area(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) sum += area_normal(mesh, t).norm() / 2.0;
  return sum;
}

Eigen::VectorXd vertex_areas(const TriangleMesh& mesh) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const double third = area_normal(mesh, t).norm() / 6.0;
    for (int k = 0; k < 3; ++k) areas[mesh.triangles(k, t)] += third;
  }
  return areas;
}

Eigen::Matrix3Xd voronoi_shares(const TriangleMesh& mesh) {
  Eigen::Matrix3Xd shares(3, mesh.triangles.cols());
  for (Eigen::Index t = 0; t < shares.cols(); ++t) shares.col(t) = voronoi_shares(mesh, t);
  return shares;
}

Eigen::VectorXd voronoi_areas(const TriangleMesh& mesh) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3d own = area_normal(mesh, t).norm() / 2.0 * voronoi_shares(mesh, t);
    for (int k = 0; k < 3; ++k) areas[mesh.triangles(k, t)] += own[k];
  }
  return areas;
}

Eigen::Matrix3Xd vertex_normals(const TriangleMesh& mesh) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, mesh.vertices.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3d normal = area_normal(mesh, t);
    for (int k = 0; k < 3; ++k) normals.col(mesh.triangles(k, t)) += normal;
  }
  for (auto normal : normals.colwise()) {
    const double length = normal.stableNorm();
    if (length > 0.0 && std::isfinite(length)) {
      normal /= length;
      normal.normalize();  // a subnormal length leaves the first division inexact
    } else {
      normal = Eigen::Vector3d::UnitZ();
    }
  }
  return normals;
}

double signed_volume(const TriangleMesh& mesh) {
  if (mesh.vertices.cols() == 0) return 0.0;
  // Measured from a vertex, a mesh far from the origin keeps its digits.
  const Eigen::Vector3d origin = mesh.vertices.col(0);
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3d a = mesh.vertices.col(mesh.triangles(0, t)) - origin;
    sum += a.dot(area_normal(mesh, t)) / 6.0;
  }
  return sum;
}

Edges edges(const TriangleMesh& mesh) {
  Edges result;
  const std::vector<HalfEdge> sides = sorted_half_edges(mesh);
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t end = first + 1;
    while (end < sides.size() && sides[end].from == sides[first].from &&
           sides[end].to == sides[first].to) {
      ++end;
    }
    if (end - first > 2) {
      throw InputError(
          fmt::format("the edge between vertices {} and {} has {} triangles: at most 2 are allowed",
                      sides[first].from, sides[first].to, end - first));
    }
    result.vertices.push_back({sides[first].from, sides[first].to});
    result.opposite.push_back(
        {sides[first].opposite, end - first == 2 ? sides[end - 1].opposite : -1});
    first = end;
  }
  return result;
}

std::vector<int> boundary_vertices(const TriangleMesh& mesh) {
  const Edges all = edges(mesh);
  std::vector<int> boundary;
  for (std::size_t e = 0; e < all.vertices.size(); ++e) {
    if (all.opposite[e][1] < 0) {
      boundary.insert(boundary.end(), all.vertices[e].begin(), all.vertices[e].end());
    }
  }
  std::sort(boundary.begin(), boundary.end());
  boundary.erase(std::unique(boundary.begin(), boundary.end()), boundary.end());
  return boundary;
}

}  // namespace pliant
