#include "pliant/models/viscoelastic/particle_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "pliant/core/parallel.h"
#include "pliant/geometry/marching_cubes.h"
#include "pliant/math/sph_kernels.h"

namespace pliant {
namespace {

constexpr float kLevel = 0.5f;
// A particle is at the boundary where its surroundings are filled less than this, or lie further to
// one side than this share of the support.
constexpr double kFull = 0.93;
constexpr double kAside = 0.08;
// Where a particle's place is filled less than this, as in a film one particle thick, it counts for
// more until it is: films and threads do not vanish.
constexpr double kThin = 0.65;
// Closed parts that hold less than so many particles are left out: drops that come and go.
constexpr double kLeastParticles = 1.5;

std::size_t at(int k) { return static_cast<std::size_t>(k); }

using Cell = NeighborLists::Cell;

bool before(const Cell& a, const Cell& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

}  // namespace

void ParticleSurface::update(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& volumes,
                             double support, int detail) {
  x_ = x;
  volumes_ = volumes;
  support_ = support;
  detail_ = detail;
  step_ = support / detail;
  lists_.build(x, support);
  find_blocks();
  const int nodes = detail * detail * detail;
  values_.assign(blocks_.size() * at(nodes), 0.0f);
  parallel_for(0, static_cast<int>(blocks_.size()), 16, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) fill_block(b);
  });
  polygonise();
  drop_small_parts();
}

void ParticleSurface::find_blocks() {
  const SphKernels kernels(support_);
  const std::vector<int>& order = lists_.order();
  std::vector<char> boundary(order.size());
  weights_.resize(order.size());
  parallel_for(0, lists_.size(), 256, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const Eigen::Vector3d own = x_.col(order[at(k)]);
      double sum = volumes_[order[at(k)]] * kernels.poly6(0.0);
      Eigen::Vector3d aside = Eigen::Vector3d::Zero();
      for (const int* j = lists_.begin(k); j != lists_.end(k); ++j) {
        const int i = order[at(*j)];
        const double w = volumes_[i] * kernels.poly6((x_.col(i) - own).squaredNorm());
        sum += w;
        aside += w * (x_.col(i) - own);
      }
      weights_[at(k)] = volumes_[order[at(k)]] * std::max(1.0, kThin / sum);
      boundary[at(k)] = sum < kFull || aside.norm() > kAside * support_ * sum;
    }
  });
  std::vector<Cell> cells;
  for (int c = 0; c < lists_.cells(); ++c) {
    const bool any = std::any_of(boundary.begin() + lists_.cell_begin(c),
                                 boundary.begin() + lists_.cell_begin(c + 1),
                                 [](char is_boundary) { return is_boundary != 0; });
    if (!any) continue;
    const Cell middle = lists_.cell(c);
    for (int code = 0; code < 27; ++code) {
      cells.push_back(middle + Cell(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1));
    }
  }
  std::sort(cells.begin(), cells.end(), before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  blocks_.resize(cells.size());
  parallel_for(0, static_cast<int>(cells.size()), 256, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      blocks_[at(b)].cell = cells[at(b)];
      for (int n = 0; n < 8; ++n) {
        const Cell cell = cells[at(b)] + Cell(n & 1, n >> 1 & 1, n >> 2 & 1);
        const auto found = std::lower_bound(cells.begin(), cells.end(), cell, before);
        blocks_[at(b)].neighbors[at(n)] =
            found != cells.end() && *found == cell ? static_cast<int>(found - cells.begin()) : -1;
      }
    }
  });
}

Eigen::Vector3d ParticleSurface::position(int block, const Eigen::Array3i& node) const {
  return lists_.origin() + support_ * blocks_[at(block)].cell.cast<double>() +
         step_ * node.cast<double>().matrix();
}

void ParticleSurface::fill_block(int block) {
  const SphKernels kernels(support_);
  const auto h2 = static_cast<float>(support_ * support_);
  // V W of a particle: V poly6(0) / H⁶ (H² − r²)³.
  const double scale = kernels.poly6(0.0) / std::pow(support_, 6.0);
  const Eigen::Vector3d corner = position(block, Eigen::Array3i::Zero());
  float* const values = values_.data() + at(block) * at(detail_ * detail_ * detail_);
  const auto step = static_cast<float>(step_);
  for (const auto& row : lists_.rows_about(blocks_[at(block)].cell)) {
    for (int k = row[0]; k < row[1]; ++k) {
      const int i = lists_.order()[at(k)];
      const Eigen::Vector3f from = (corner - x_.col(i)).cast<float>();
      const auto weight = static_cast<float>(scale * weights_[at(k)]);
      float* value = values;
      for (int z = 0; z < detail_; ++z) {
        const float dz = from[2] + step * static_cast<float>(z);
        for (int y = 0; y < detail_; ++y) {
          const float dy = from[1] + step * static_cast<float>(y);
          const float left = h2 - dz * dz - dy * dy;
          for (int x = 0; x < detail_; ++x, ++value) {
            const float dx = from[0] + step * static_cast<float>(x);
            const float u = std::max(0.0f, left - dx * dx);
            *value += weight * u * u * u;
          }
        }
      }
    }
  }
}

std::array<int, 2> ParticleSurface::locate(int block, const Eigen::Array3i& node) const {
  Eigen::Array3i own = node;
  int neighbor = 0;
  for (int a = 0; a < 3; ++a) {
    if (own[a] < detail_) continue;
    own[a] -= detail_;
    neighbor |= 1 << a;
  }
  return {blocks_[at(block)].neighbors[at(neighbor)],
          own[0] + detail_ * (own[1] + detail_ * own[2])};
}

float ParticleSurface::value(const std::array<int, 2>& node) const {
  return values_[at(node[0]) * at(detail_ * detail_ * detail_) + at(node[1])];
}

int ParticleSurface::vertex_on(int block, const Eigen::Array3i& node, int axis) {
  const std::array<int, 2> low = locate(block, node);
  int& vertex =
      vertex_of_[(at(low[0]) * at(detail_ * detail_ * detail_) + at(low[1])) * 3 + at(axis)];
  if (vertex >= 0) return vertex;
  Eigen::Array3i other = node;
  ++other[axis];
  const float a = value(low), b = value(locate(block, other));
  // Not onto a corner, where triangles would have no area.
  const double share = std::clamp(static_cast<double>((kLevel - a) / (b - a)), 1e-3, 1.0 - 1e-3);
  vertices_.emplace_back((1.0 - share) * position(block, node) + share * position(block, other));
  return vertex = static_cast<int>(vertices_.size()) - 1;
}

void ParticleSurface::polygonise() {
  vertices_.clear();
  triangles_.clear();
  vertex_of_.assign(3 * values_.size(), -1);
  const int cubes = detail_ * detail_ * detail_;
  for (int b = 0; b < static_cast<int>(blocks_.size()); ++b) {
    for (int c = 0; c < cubes; ++c) {
      const Eigen::Array3i low(c % detail_, c / detail_ % detail_, c / (detail_ * detail_));
      int inside = 0;
      bool complete = true;
      for (int k = 0; k < 8 && complete; ++k) {
        const auto node = locate(b, low + Eigen::Array3i(k & 1, k >> 1 & 1, k >> 2 & 1));
        complete = node[0] >= 0;
        if (complete && value(node) > kLevel) inside |= 1 << k;
      }
      if (!complete || inside == 0 || inside == 255) continue;
      for (const MarchingCubes::Triangle& triangle : MarchingCubes::triangles(inside)) {
        Eigen::Vector3i corners;
        for (int k = 0; k < 3; ++k) {
          const int edge = triangle[at(k)], corner = MarchingCubes::edge_corner(edge);
          corners[k] =
              vertex_on(b, low + Eigen::Array3i(corner & 1, corner >> 1 & 1, corner >> 2 & 1),
                        MarchingCubes::edge_axis(edge));
        }
        triangles_.push_back(corners);
      }
    }
  }
}

void ParticleSurface::drop_small_parts() {
  std::vector<int> root(vertices_.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int v) {
    while (root[at(v)] != v) v = root[at(v)] = root[at(root[at(v)])];
    return v;
  };
  for (const Eigen::Vector3i& t : triangles_) {
    for (int k = 0; k < 2; ++k) {
      const int a = find(t[k]), b = find(t[k + 1]);
      root[at(std::max(a, b))] = std::min(a, b);
    }
  }
  std::vector<double> volume(vertices_.size(), 0.0);
  for (const Eigen::Vector3i& t : triangles_) {
    // From a vertex of the part itself, so that no digits are lost.
    const int part = find(t[0]);
    const Eigen::Vector3d& from = vertices_[at(part)];
    volume[at(part)] += (vertices_[at(t[0])] - from)
                            .cross(vertices_[at(t[1])] - from)
                            .dot(vertices_[at(t[2])] - from) /
                        6.0;
  }
  const double least = kLeastParticles * (volumes_.size() > 0 ? volumes_.mean() : 0.0);
  std::vector<int> number(vertices_.size(), -1);
  int vertices = 0, triangles = 0;
  for (int v = 0; v < static_cast<int>(vertices_.size()); ++v) {
    if (std::abs(volume[at(find(v))]) >= least) number[at(v)] = vertices++;
  }
  mesh_.vertices.resize(3, vertices);
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    if (number[v] >= 0) mesh_.vertices.col(number[v]) = vertices_[v];
  }
  mesh_.triangles.resize(3, static_cast<Eigen::Index>(triangles_.size()));
  for (const Eigen::Vector3i& t : triangles_) {
    if (number[at(t[0])] < 0) continue;
    mesh_.triangles.col(triangles++) =
        Eigen::Vector3i(number[at(t[0])], number[at(t[1])], number[at(t[2])]);
  }
  mesh_.triangles.conservativeResize(3, triangles);
}

Eigen::VectorXd ParticleSurface::interpolate(const Eigen::VectorXd& field) const {
  const SphKernels kernels(support_);
  Eigen::VectorXd result(mesh_.vertices.cols());
  for (Eigen::Index v = 0; v < mesh_.vertices.cols(); ++v) {
    const Eigen::Vector3d p = mesh_.vertices.col(v);
    const Cell cell = ((p - lists_.origin()) / support_).array().floor().matrix().cast<int>();
    double sum = 0.0, weights = std::numeric_limits<double>::min();
    for (const auto& row : lists_.rows_about(cell)) {
      for (int k = row[0]; k < row[1]; ++k) {
        const int i = lists_.order()[at(k)];
        const double w = volumes_[i] * kernels.poly6((x_.col(i) - p).squaredNorm());
        sum += w * field[i];
        weights += w;
      }
    }
    result[v] = sum / weights;
  }
  return result;
}

}  // namespace pliant
