#include "pliant/effects/self_contact/self_contact_parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pliant/geometry/distance/barycentric.h"
#include "pliant/geometry/mesh/tetrahedron_faces.h"
#include "pliant/geometry/meshing/embedding.h"
#include "pliant/geometry/meshing/outreach.h"

namespace pliant {
namespace {

// Share of a tetrahedron's edge to which it is known how far the surface stands out.
constexpr double kExactness = 0.1;

double longest_edge(const Eigen::Matrix<double, 3, 4>& corners) {
  double squared = 0.0;
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < a; ++b) {
      squared = std::max(squared, (corners.col(a) - corners.col(b)).squaredNorm());
    }
  }
  return std::sqrt(squared);
}

/// Every particle as a point.
EmbeddedPoints every_particle(int count) {
  Eigen::Matrix4Xd weights = Eigen::Matrix4Xd::Zero(4, count);
  weights.row(0).setOnes();
  return {Eigen::RowVectorXi::LinSpaced(count, 0, count - 1).replicate<4, 1>(), weights};
}

}  // namespace

SelfContactParts::SelfContactParts(const TetrahedralMesh& rest, const Eigen::Matrix3Xi& triangles,
                                   const EmbeddedPoints* surface, const EmbeddedPoints* contact)
    : rest_(rest) {
  validate(rest_, "self_contact");
  find_parts();
  for (int t = 0; t < rest_.tetrahedra.cols(); ++t) {
    longest_edges_.push_back(longest_edge(corners_of(rest_.vertices, rest_.tetrahedra.col(t))));
  }
  if (surface != nullptr) {
    surface_ = *surface;
  } else {
    surface_ = every_particle(static_cast<int>(rest_.vertices.cols()));
  }
  rest_surface_.resize(3, surface_.size());
  surface_.positions(rest_.vertices, rest_surface_);
  if (surface != nullptr) {
    take_surface(triangles);
  } else {
    take_boundary();
  }
  sort_triangles();
  if (contact != nullptr) {
    points_ = *contact;
  } else {
    take_boundary_points();
  }
  rest_points_.resize(3, points_.size());
  points_.positions(rest_.vertices, rest_points_);
}

void SelfContactParts::find_parts() {
  std::vector<int> parents(static_cast<std::size_t>(rest_.vertices.cols()));
  std::iota(parents.begin(), parents.end(), 0);
  const auto root = [&](int i) {
    while (parents[static_cast<std::size_t>(i)] != i) {
      int& parent = parents[static_cast<std::size_t>(i)];
      parent = parents[static_cast<std::size_t>(parent)];
      i = parent;
    }
    return i;
  };
  for (const auto tetrahedron : rest_.tetrahedra.colwise()) {
    for (int k = 1; k < 4; ++k) {
      const int a = root(tetrahedron[0]), b = root(tetrahedron[k]);
      parents[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  particle_parts_.resize(parents.size());
  int parts = 0;
  for (int i = 0; i < static_cast<int>(parents.size()); ++i) {
    const int first = root(i);  // the least of its part
    particle_parts_[static_cast<std::size_t>(i)] =
        first == i ? parts++ : particle_parts_[static_cast<std::size_t>(first)];
  }
  first_triangles_.assign(static_cast<std::size_t>(parts), 0);
}

void SelfContactParts::take_boundary() {
  const std::vector<TetrahedronFace> faces = sorted_faces(rest_.tetrahedra);
  for (std::size_t f = 0; f < faces.size(); f = end_of_same_face(faces, f)) {
    if (end_of_same_face(faces, f) != f + 1) continue;
    EmbeddedTriangle triangle;
    triangle.particles = rest_.tetrahedra.col(faces[f].tetrahedron);
    triangle.weights.setZero();
    triangle.vertices = face_vertices(triangle.particles, faces[f].face);
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 4; ++k) {
        triangle.weights(k, c) = triangle.particles[k] == triangle.vertices[c];
      }
    }
    triangles_.push_back(triangle);
  }
}

void SelfContactParts::take_surface(const Eigen::Matrix3Xi& triangles) {
  Eigen::Matrix3Xd middles(3, triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    EmbeddedTriangle triangle;
    triangle.vertices = triangles.col(t);
    triangles_.push_back(triangle);
    middles.col(t) = triangle.corners(rest_surface_).rowwise().mean();
  }
  // The tetrahedron of its middle takes a triangle's forces: a corner's may lie off the triangle.
  const Embedding embedding = embed(middles, rest_, "self_contact");
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    EmbeddedTriangle& triangle = triangles_[t];
    triangle.particles = rest_.tetrahedra.col(embedding.tetrahedron[static_cast<Eigen::Index>(t)]);
    const Barycentric barycentric(corners_of(rest_.vertices, triangle.particles));
    for (int c = 0; c < 3; ++c) {
      triangle.weights.col(c) = barycentric(rest_surface_.col(triangle.vertices[c]));
    }
  }
  double edges = 0.0;
  for (const double edge : longest_edges_) edges += edge;
  const double tolerance = kExactness * edges / static_cast<double>(longest_edges_.size());
  bulge_ = outreach({rest_surface_, triangles}, rest_, tolerance, "self_contact");
}

void SelfContactParts::take_boundary_points() {
  std::vector<char> on_boundary(particle_parts_.size(), 0);
  for (const EmbeddedTriangle& triangle : triangles_) {
    for (int k = 0; k < 4; ++k) {
      if (triangle.weights.row(k).cwiseAbs().maxCoeff() > 0.0) {
        on_boundary[static_cast<std::size_t>(triangle.particles[k])] = 1;
      }
    }
  }
  // Each by a tetrahedron of its own, so that a force beside it has somewhere to go.
  Eigen::Matrix4Xi particles(4, static_cast<Eigen::Index>(on_boundary.size()));
  Eigen::Matrix4Xd weights = Eigen::Matrix4Xd::Zero(4, particles.cols());
  Eigen::Index count = 0;
  for (const auto tetrahedron : rest_.tetrahedra.colwise()) {
    for (int k = 0; k < 4; ++k) {
      char& wanted = on_boundary[static_cast<std::size_t>(tetrahedron[k])];
      if (wanted == 0) continue;
      wanted = 0;
      particles.col(count) = tetrahedron;
      weights(k, count++) = 1.0;
    }
  }
  points_ = EmbeddedPoints(particles.leftCols(count), weights.leftCols(count));
}

void SelfContactParts::sort_triangles() {
  for (EmbeddedTriangle& triangle : triangles_) {
    triangle.part = part_of_particle(triangle.particles[0]);
  }
  std::stable_sort(
      triangles_.begin(), triangles_.end(),
      [](const EmbeddedTriangle& a, const EmbeddedTriangle& b) { return a.part < b.part; });
  auto begin = triangles_.begin();
  for (int part = 0; part < static_cast<int>(first_triangles_.size()); ++part) {
    const auto end = std::find_if(begin, triangles_.end(),
                                  [&](const EmbeddedTriangle& t) { return t.part != part; });
    first_triangles_[static_cast<std::size_t>(part)] = static_cast<int>(begin - triangles_.begin());
    TriangleMesh mesh{Eigen::Matrix3Xd(3, 3 * (end - begin)), Eigen::Matrix3Xi(3, end - begin)};
    for (Eigen::Index t = 0; begin != end; ++begin, ++t) {
      mesh.vertices.middleCols<3>(3 * t) = begin->corners(rest_surface_);
      mesh.triangles.col(t) =
          Eigen::Vector3i::LinSpaced(static_cast<int>(3 * t), static_cast<int>(3 * t) + 2);
    }
    nearest_.emplace_back(std::move(mesh));
  }
}

NearestTriangle::Result SelfContactParts::nearest(int part, const Eigen::Vector3d& at) const {
  NearestTriangle::Result result = nearest_[static_cast<std::size_t>(part)](at);
  result.triangle += first_triangles_[static_cast<std::size_t>(part)];
  return result;
}

}  // namespace pliant
