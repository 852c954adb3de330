#include "pliant/elements/cloth/cell_shear_set.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/core/parallel/parallel_reduce.h"
#include "pliant/elements/coloring.h"
#include "pliant/elements/solids/strain_damping_set.h"
#include "pliant/laws/spring.h"
#include "pliant/math/error.h"
#include "pliant/math/vector_traits_eigen.h"

namespace pliant {
namespace {

constexpr int kGrain = 96;  // in less, threads cost more than they save
constexpr int kSumGrain = 1024;

struct Diagonal {
  int from, to;
  double x, y, z, length;

  Diagonal(const double* positions, int i, int j) : from(i), to(j) {
    const double *a = positions + 3 * i, *b = positions + 3 * j;
    x = a[0] - b[0];
    y = a[1] - b[1];
    z = a[2] - b[2];
    length = divisor_of(Double3{x, y, z});
  }
  /// target[from] += at_from d, target[to] -= at_to d.
  void add(double at_from, double at_to, double* target) const {
    double *a = target + 3 * from, *b = target + 3 * to;
    a[0] += at_from * x;
    a[1] += at_from * y;
    a[2] += at_from * z;
    b[0] -= at_to * x;
    b[1] -= at_to * y;
    b[2] -= at_to * z;
  }
};

struct Diagonals {
  Diagonal d, e;
  Diagonals(const double* x, const ShearCell& cell)
      : d(x, cell.corners[0], cell.corners[2]), e(x, cell.corners[1], cell.corners[3]) {}
  double difference() const { return d.length - e.length; }
};

void check(const ShearCell& cell, std::size_t number, int particles) {
  const auto& v = cell.corners;
  bool good = std::isfinite(cell.stiffness) && cell.stiffness > 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    good = good && v[k] >= 0 && v[k] < particles;
    for (std::size_t l = 0; l < k; ++l) good = good && v[k] != v[l];
  }
  if (good) return;
  throw InputError(fmt::format(
      "shear cell {}: particles {}, {}, {} and {} of {}, stiffness {} N/m; needs four different "
      "particles and a positive stiffness",
      number, v[0], v[1], v[2], v[3], particles, cell.stiffness));
}

/// Along n with 1, across it with `across`.
Eigen::Matrix3d block(const Eigen::Vector3d& n, double across) {
  return across * Eigen::Matrix3d::Identity() + (1.0 - across) * n * n.transpose();
}

}  // namespace

CellShearSet::CellShearSet(const std::vector<ShearCell>& cells, int particles)
    : multipliers_(cells.size(), 0.0) {
  std::vector<int> vertices;
  vertices.reserve(4 * cells.size());
  for (std::size_t e = 0; e < cells.size(); ++e) {
    check(cells[e], e, particles);
    vertices.insert(vertices.end(), cells[e].corners.begin(), cells[e].corners.end());
  }
  const Coloring coloring = color_elements(vertices, 4, particles);
  begins_ = coloring.begins;
  cells_.reserve(cells.size());
  for (int e : coloring.order) cells_.push_back(cells[static_cast<std::size_t>(e)]);
}

double CellShearSet::energy(const Positions& x) const {
  return parallel_sum(0, size(), kSumGrain, [&](int number) {
    const ShearCell& cell = cells_[static_cast<std::size_t>(number)];
    const double difference = Diagonals(x.data(), cell).difference();
    return 0.5 * cell.stiffness * difference * difference;
  });
}

void CellShearSet::add_forces(const Positions& x, Forces& f) const {
  for (std::size_t c = 0; c + 1 < begins_.size(); ++c) {
    parallel_for(begins_[c], begins_[c + 1], kGrain, [&](int begin, int end) {
      for (int number = begin; number < end; ++number) {
        const ShearCell& cell = cells_[static_cast<std::size_t>(number)];
        const Diagonals both(x.data(), cell);
        const double along_d = cell_share(cell.stiffness, both.d.length, both.e.length);
        const double along_e = cell_share(cell.stiffness, both.e.length, both.d.length);
        both.d.add(-along_d, -along_d, f.data());
        both.e.add(-along_e, -along_e, f.data());
      }
    });
  }
}

void CellShearSet::add_to_system(SystemMatrix& a) const {
  // E is k times the squared distance of (d, e) to the nearest pair of one length.
  for (const ShearCell& cell : cells_) {
    for (std::size_t k = 0; k < 2; ++k) {
      const int i = cell.corners[k], j = cell.corners[k + 2];
      const double weight = 2.0 * cell.stiffness;
      a.add(i, i, weight);
      a.add(j, j, weight);
      a.add(i, j, -weight);
      a.add(j, i, -weight);
    }
  }
}

void CellShearSet::add_stiffness(const Positions& x, Definiteness definiteness,
                                 StiffnessMatrix& k) const {
  for (const ShearCell& cell : cells_) {
    const auto& v = cell.corners;
    const Eigen::Vector3d d = x.col(v[0]) - x.col(v[2]), e = x.col(v[1]) - x.col(v[3]);
    const double ld = divisor_of(d), le = divisor_of(e);
    // A diagonal without length has no direction: its force is constant.
    double across[2] = {ld > kNoDirection<double> ? 1.0 - le / ld : 0.0,
                        le > kNoDirection<double> ? 1.0 - ld / le : 0.0};
    if (definiteness == Definiteness::kProjected) {
      for (double& value : across) value = std::max(value, 0.0);
    }
    const Eigen::Vector3d n[2] = {d / ld, e / le};
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < 4; ++c) {
        const double sign = (r < 2) == (c < 2) ? cell.stiffness : -cell.stiffness;
        const Eigen::Matrix3d entry = r % 2 == c % 2 ? block(n[r % 2], across[r % 2])
                                                     : (-n[r % 2] * n[c % 2].transpose()).eval();
        k.add(v[r], v[c], sign * entry);
      }
    }
  }
}

void CellShearSet::add_damping(double time, std::vector<std::unique_ptr<ElementSet>>& sets) const {
  std::vector<StrainMeasure> strains;
  for (const ShearCell& cell : cells_) {
    StrainMeasure strain;
    strain.particles.assign(cell.corners.begin(), cell.corners.end());
    strain.first = {1.0, 0.0, -1.0, 0.0};
    strain.second = {0.0, 1.0, 0.0, -1.0};
    strain.stiffness = cell.stiffness;
    strains.push_back(strain);
  }
  sets.push_back(std::make_unique<StrainDampingSet>(strains, time));
}

void CellShearSet::reset_multipliers() { std::fill(multipliers_.begin(), multipliers_.end(), 0.0); }

void CellShearSet::relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) {
  const double dt2 = dt * dt;
  const auto mobility = [&](int i) { return inverse_mass[i]; };
  for (std::size_t c = 0; c + 1 < begins_.size(); ++c) {
    parallel_for(begins_[c], begins_[c + 1], kGrain, [&](int begin, int end) {
      for (int number = begin; number < end; ++number) {
        const ShearCell& cell = cells_[static_cast<std::size_t>(number)];
        const auto& v = cell.corners;
        const Diagonals both(x.data(), cell);
        const double w = mobility(v[0]) + mobility(v[1]) + mobility(v[2]) + mobility(v[3]);
        // The spring's formula with the constraint |d| - |e|, whose gradients are unit vectors.
        double& lambda = multipliers_[static_cast<std::size_t>(number)];
        const double k = cell.stiffness;
        const double delta = -(k * both.difference() + lambda) / (k * dt2 * w + 1.0);
        lambda += delta;
        const double along_d = dt2 * delta / both.d.length, along_e = dt2 * delta / both.e.length;
        both.d.add(mobility(v[0]) * along_d, mobility(v[2]) * along_d, x.data());
        both.e.add(-mobility(v[1]) * along_e, -mobility(v[3]) * along_e, x.data());
      }
    });
  }
}

}  // namespace pliant
