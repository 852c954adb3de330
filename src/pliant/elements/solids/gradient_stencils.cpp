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

/// A tetrahedron, and the share of its volume that belongs to what it is listed for.
struct Share {
  int tetrahedron;
  double share;
};

GradientStencils averaged(const GradientStencils& tetrahedra,
                          const std::vector<std::vector<Share>>& groups) {
  GradientStencils result;
  for (const std::vector<Share>& group : groups) {
    if (group.empty()) continue;
    double volume = 0.0;
    for (const auto& [t, share] : group) volume += share * tetrahedra.volume(t);
    std::map<int, Eigen::Vector3d> sums;
    for (const auto& [t, share] : group) {
      for (int k = tetrahedra.begin(t); k < tetrahedra.end(t); ++k) {
        const auto [sum, is_new] =
            sums.try_emplace(tetrahedra.particle(k), Eigen::Vector3d::Zero());
        sum->second += share * tetrahedra.volume(t) / volume * tetrahedra.shape(k);
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
  constexpr std::array<std::array<int, 2>, 6> kEdges = {
      {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  const GradientStencils tetrahedra = tetrahedron_stencils(name, rest, first_particle);
  std::map<std::pair<int, int>, std::vector<Share>> around;
  for (int t = 0; t < rest.tetrahedra.cols(); ++t) {
    for (const auto& [a, b] : kEdges) {
      const auto edge = std::minmax(rest.tetrahedra(a, t), rest.tetrahedra(b, t));
      around[{edge.first, edge.second}].push_back({t, 1.0 / 6.0});
    }
  }
  std::vector<std::vector<Share>> groups;
  for (const auto& [edge, shares] : around) groups.push_back(shares);
  return averaged(tetrahedra, groups);
}

GradientStencils vertex_means(const GradientStencils& tetrahedra, const std::vector<bool>& pinned) {
  const auto is_pinned = [&](int i) {
    return !pinned.empty() && pinned[static_cast<std::size_t>(i)];
  };
  std::map<int, std::vector<Share>> around;
  for (int t = 0; t < tetrahedra.size(); ++t) {
    int takers = 0;
    for (int k = tetrahedra.begin(t); k < tetrahedra.end(t); ++k) {
      takers += is_pinned(tetrahedra.particle(k)) ? 0 : 1;
    }
    for (int k = tetrahedra.begin(t); k < tetrahedra.end(t); ++k) {
      const int i = tetrahedra.particle(k);
      if (takers > 0 && is_pinned(i)) continue;
      around[i].push_back({t, 1.0 / (takers > 0 ? takers : 4)});
    }
  }
  std::vector<std::vector<Share>> groups;
  for (const auto& [vertex, shares] : around) groups.push_back(shares);
  return averaged(tetrahedra, groups);
}

}  // namespace pliant
