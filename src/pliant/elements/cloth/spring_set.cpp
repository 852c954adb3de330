#include "pliant/elements/cloth/spring_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/core/parallel/parallel_reduce.h"
#include "pliant/elements/coloring.h"
#include "pliant/elements/solids/strain_damping_set.h"
#include "pliant/laws/spring.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr int kGrain = 192;  // in less, threads cost more than they save
constexpr int kSumGrain = 2048;

Double3 difference(const double* positions, const Spring& s) {
  const double* a = positions + 3 * s.i;
  const double* b = positions + 3 * s.j;
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

void add_scaled(double* target, double scale, const Double3& d) {
  target[0] += scale * d.x;
  target[1] += scale * d.y;
  target[2] += scale * d.z;
}

void check(const std::string& name, const Spring& s, std::size_t number, int particles) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  const bool in_range = s.i >= 0 && s.j >= 0 && s.i < particles && s.j < particles && s.i != s.j;
  if (in_range && positive(s.rest_length) && positive(s.stiffness)) return;
  throw InputError(fmt::format(
      "{} spring {}: particles {} and {} of {}, rest length {} m, stiffness {} N/m; needs two "
      "different particles, a positive rest length and a positive stiffness",
      name, number, s.i, s.j, particles, s.rest_length, s.stiffness));
}

}  // namespace

SpringSet::SpringSet(std::string name, const std::vector<Spring>& springs, int particles)
    : name_(std::move(name)) {
  std::vector<int> vertices;
  vertices.reserve(2 * springs.size());
  for (std::size_t e = 0; e < springs.size(); ++e) {
    check(name_, springs[e], e, particles);
    vertices.push_back(springs[e].i);
    vertices.push_back(springs[e].j);
  }
  const Coloring coloring = color_elements(vertices, 2, particles);
  begins_ = coloring.begins;
  springs_.reserve(springs.size());
  for (int e : coloring.order) springs_.push_back(springs[static_cast<std::size_t>(e)]);
}

double SpringSet::energy(const Positions& x) const {
  return parallel_sum(0, size(), kSumGrain, [&](int e) {
    const Spring& s = springs_[static_cast<std::size_t>(e)];
    const double stretch = divisor_of(difference(x.data(), s)) - s.rest_length;
    return 0.5 * s.stiffness * stretch * stretch;
  });
}

void SpringSet::add_forces(const Positions& x, Forces& f) const {
  const double* positions = x.data();
  double* forces = f.data();
  for (std::size_t c = 0; c + 1 < begins_.size(); ++c) {
    parallel_for(begins_[c], begins_[c + 1], kGrain, [&](int begin, int end) {
      for (int e = begin; e < end; ++e) {
        const Spring& s = springs_[static_cast<std::size_t>(e)];
        const Double3 d = difference(positions, s);
        const double scale = spring_share(s.stiffness, s.rest_length, divisor_of(d));
        add_scaled(forces + 3 * s.i, -scale, d);
        add_scaled(forces + 3 * s.j, scale, d);
      }
    });
  }
}

void SpringSet::add_to_system(SystemMatrix& a) const {
  for (const Spring& s : springs_) {
    a.add(s.i, s.i, s.stiffness);
    a.add(s.j, s.j, s.stiffness);
    a.add(s.i, s.j, -s.stiffness);
    a.add(s.j, s.i, -s.stiffness);
  }
}

void SpringSet::add_stiffness(const Positions& x, Definiteness definiteness,
                              StiffnessMatrix& k) const {
  for (const Spring& s : springs_) {
    const Eigen::Vector3d d = x.col(s.i) - x.col(s.j);
    const double l = d.norm();
    // K_ii = k [n n^T + (1 - l_0/l) (I - n n^T)]; a compressed spring's second part is negative. A
    // spring without length has no direction: its force is constant.
    if (l < kNoDirection<double>) continue;
    const Eigen::Vector3d n = d / l;
    const Eigen::Matrix3d along = n * n.transpose();
    double across = 1.0 - s.rest_length / l;
    if (definiteness == Definiteness::kProjected) across = std::max(across, 0.0);
    const Eigen::Matrix3d block =
        s.stiffness * (along + across * (Eigen::Matrix3d::Identity() - along));
    k.add(s.i, s.i, block);
    k.add(s.j, s.j, block);
    k.add(s.i, s.j, -block);
    k.add(s.j, s.i, -block);
  }
}

void SpringSet::add_damping(double time, std::vector<std::unique_ptr<ElementSet>>& sets) const {
  std::vector<StrainMeasure> strains;
  for (const Spring& s : springs_) {
    StrainMeasure strain;
    strain.particles = {s.i, s.j};
    strain.first = {1.0, -1.0};
    strain.stiffness = s.stiffness;
    strains.push_back(strain);
  }
  sets.push_back(std::make_unique<StrainDampingSet>(strains, time));
}

void SpringSet::reset_multipliers() { std::fill(multipliers_.begin(), multipliers_.end(), 0.0); }

void SpringSet::relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) {
  double* positions = x.data();
  const double* w = inverse_mass.data();
  const double dt2 = dt * dt;
  // Solvers that do not relax need none.
  if (multipliers_.empty()) multipliers_.assign(springs_.size(), 0.0);
  for (std::size_t c = 0; c + 1 < begins_.size(); ++c) {
    parallel_for(begins_[c], begins_[c + 1], kGrain, [&](int begin, int end) {
      for (int e = begin; e < end; ++e) {
        const Spring& s = springs_[static_cast<std::size_t>(e)];
        double& lambda = multipliers_[static_cast<std::size_t>(e)];
        const Double3 d = difference(positions, s);
        const double l = divisor_of(d);
        const double wi = w[s.i], wj = w[s.j];
        // Δλ = -(C + λ/k) / (w_i + w_j + 1/(k h²)) / h², with λ in newton (Macklin et al. 2016, eq.
        // 18).
        const double k = s.stiffness;
        const double numerator = -(k * (l - s.rest_length) + lambda);
        // One division serves both Δλ and Δλ / l.
        const double shared = numerator / ((k * dt2 * (wi + wj) + 1.0) * l);
        lambda += shared * l;
        const double scale = dt2 * shared;
        add_scaled(positions + 3 * s.i, wi * scale, d);
        add_scaled(positions + 3 * s.j, -wj * scale, d);
      }
    });
  }
}

Eigen::VectorXd SpringSet::strains(const Positions& x) const {
  Eigen::VectorXd strains(size());
  for (int e = 0; e < size(); ++e) {
    const Spring& s = springs_[static_cast<std::size_t>(e)];
    strains[e] = divisor_of(difference(x.data(), s)) / s.rest_length - 1.0;
  }
  return strains;
}

void SpringSet::add_strains(const Positions& x, Eigen::VectorXd& sum,
                            Eigen::VectorXd& count) const {
  const Eigen::VectorXd each = strains(x);
  for (int e = 0; e < size(); ++e) {
    for (int i :
         {springs_[static_cast<std::size_t>(e)].i, springs_[static_cast<std::size_t>(e)].j}) {
      sum[i] += each[e];
      count[i] += 1.0;
    }
  }
}

void SpringSet::add_yarns(std::vector<Yarn>& yarns) const {
  for (const Spring& s : springs_) {
    yarns.push_back({{s.i, s.j, s.i}, {-1.0, 1.0, 0.0}, s.rest_length});
  }
}

void SpringSet::add_edges(std::vector<ClothEdge>& edges) const {
  for (const Spring& s : springs_) edges.push_back({s.i, s.j, s.rest_length});
}

}  // namespace pliant
