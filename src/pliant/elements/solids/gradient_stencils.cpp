#include "pliant/elements/solids/gradient_stencils.h"

#include <algorithm>
#include <array>
#include <map>

#include "pliant/elements/solids/simplex.h"

namespace pliant {
namespace {

using TetrahedronShape = Eigen::Matrix<double, 3, 4>;

std::vector<TetrahedronShape> tetrahedron_shapes(const TetrahedralMesh& rest) {
  std::vector<TetrahedronShape> shapes;
  for (Eigen::Index t = 0; t < rest.tetrahedra.cols(); ++t) {
    Eigen::Matrix3d sides;
    for (int k = 0; k < 3; ++k) {
      sides.col(k) =
          rest.vertices.col(rest.tetrahedra(k + 1, t)) - rest.vertices.col(rest.tetrahedra(0, t));
    }
    shapes.push_back(shape_gradients<3>(sides));
  }
  return shapes;
}

/// Tetrahedra that have something in common, and the share of each that belongs to it.
GradientStencils averaged(const TetrahedralMesh& rest, int first_particle,
                          const std::vector<std::vector<int>>& groups, double share) {
  const Eigen::VectorXd sizes = volumes(rest);
  const std::vector<TetrahedronShape> shapes = tetrahedron_shapes(rest);
  GradientStencils result;
  for (const std::vector<int>& group : groups) {
    double volume = 0.0;
    for (int t : group) volume += share * sizes[t];
    std::map<int, Eigen::Vector3d> sums;
    for (int t : group) {
      for (int a = 0; a < 4; ++a) {
        const auto [sum, is_new] =
            sums.try_emplace(first_particle + rest.tetrahedra(a, t), Eigen::Vector3d::Zero());
        sum->second += share * sizes[t] / volume * shapes[static_cast<std::size_t>(t)].col(a);
      }
    }
    std::vector<int> particles;
    std::vector<Eigen::Vector3d> means;
    for (const auto& [particle, mean] : sums) {
      particles.push_back(particle);
      means.push_back(mean);
    }
    result.add(volume, particles, means);
  }
  return result;
}

}  // namespace

Eigen::Matrix3d GradientStencils::gradient(int part, const Positions& x) const {
  // Of differences, so that a body far from the origin keeps its digits.
  const int first = begin(part);
  const Eigen::Vector3d origin = x.col(particle(first));
  Eigen::Matrix3d g = Eigen::Matrix3d::Zero();
  for (int k = first + 1; k < end(part); ++k) {
    g += (x.col(particle(k)) - origin) * shape(k).transpose();
  }
  return g;
}

void GradientStencils::add(double volume, const std::vector<int>& particles,
                           const std::vector<Eigen::Vector3d>& shapes) {
  volumes_.push_back(volume);
  particles_.insert(particles_.end(), particles.begin(), particles.end());
  shapes_.insert(shapes_.end(), shapes.begin(), shapes.end());
  begins_.push_back(static_cast<int>(particles_.size()));
}

void GradientStencils::append(const GradientStencils& others) {
  const int first = entries();
  for (int part = 0; part < others.size(); ++part) begins_.push_back(first + others.end(part));
  particles_.insert(particles_.end(), others.particles_.begin(), others.particles_.end());
  shapes_.insert(shapes_.end(), others.shapes_.begin(), others.shapes_.end());
  volumes_.insert(volumes_.end(), others.volumes_.begin(), others.volumes_.end());
}

GradientStencils tetrahedron_stencils(const std::string& name, const TetrahedralMesh& rest,
                                      int first_particle) {
  validate(rest, name);
  const Eigen::VectorXd sizes = volumes(rest);
  const std::vector<TetrahedronShape> shapes = tetrahedron_shapes(rest);
  GradientStencils result;
  for (int t = 0; t < rest.tetrahedra.cols(); ++t) {
    std::vector<int> particles;
    std::vector<Eigen::Vector3d> own;
    for (int a = 0; a < 4; ++a) {
      particles.push_back(first_particle + rest.tetrahedra(a, t));
      own.push_back(shapes[static_cast<std::size_t>(t)].col(a));
    }
    result.add(sizes[t], particles, own);
  }
  return result;
}

GradientStencils edge_stencils(const std::string& name, const TetrahedralMesh& rest,
                               int first_particle) {
  validate(rest, name);
  constexpr std::array<std::array<int, 2>, 6> kEdges = {
      {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  std::map<std::pair<int, int>, std::vector<int>> around;
  for (int t = 0; t < rest.tetrahedra.cols(); ++t) {
    for (const auto& [a, b] : kEdges) {
      const auto edge = std::minmax(rest.tetrahedra(a, t), rest.tetrahedra(b, t));
      around[{edge.first, edge.second}].push_back(t);
    }
  }
  std::vector<std::vector<int>> groups;
  for (const auto& [edge, tetrahedra] : around) groups.push_back(tetrahedra);
  return averaged(rest, first_particle, groups, 1.0 / 6.0);
}

GradientStencils vertex_stencils(const std::string& name, const TetrahedralMesh& rest,
                                 int first_particle) {
  validate(rest, name);
  std::map<int, std::vector<int>> around;
  for (int t = 0; t < rest.tetrahedra.cols(); ++t) {
    for (int a = 0; a < 4; ++a) around[rest.tetrahedra(a, t)].push_back(t);
  }
  std::vector<std::vector<int>> groups;
  for (const auto& [vertex, tetrahedra] : around) groups.push_back(tetrahedra);
  return averaged(rest, first_particle, groups, 0.25);
}

}  // namespace pliant
