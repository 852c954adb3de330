#include "pliant/elements/solids/strain_damping_set.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "pliant/core/parallel/parallel_reduce.h"

namespace pliant {
namespace {

constexpr int kGrain = 64, kSumGrain = 1024;
// A shorter vector has no direction.
constexpr double kTiny = 1e-150;

using Weights = std::vector<double>;

int count_of(const StrainMeasure& m) { return static_cast<int>(m.particles.size()); }

struct Strain {
  explicit Strain(const StrainMeasure& m) : gradient(decltype(gradient)::Zero(3, count_of(m))) {}
  double value = 0.0;
  // On the stack: a step allocates nothing.
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, StrainMeasure::kMostParticles> gradient;
};

Eigen::Vector3d place(const StrainMeasure& m, int k, const Positions& x) {
  return x.col(m.particles[static_cast<std::size_t>(k)]);
}

/// Σ weight x, of differences.
Eigen::Vector3d sum(const StrainMeasure& m, const Weights& weights, const Positions& x) {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (int k = 1; k < count_of(m); ++k) {
    const double weight = weights[static_cast<std::size_t>(k)];
    if (weight != 0.0) result += weight * (place(m, k, x) - place(m, 0, x));
  }
  return result;
}

void add_weighted(const Weights& weights, const Eigen::Vector3d& v, Strain& strain) {
  for (std::size_t k = 0; k < weights.size(); ++k) {
    strain.gradient.col(static_cast<Eigen::Index>(k)) += weights[k] * v;
  }
}

void add_length(const StrainMeasure& m, const Weights& weights, double sign, const Positions& x,
                Strain& strain) {
  const Eigen::Vector3d v = sum(m, weights, x);
  const double length = v.norm();
  strain.value += sign * length;
  if (length > kTiny) add_weighted(weights, sign / length * v, strain);
}

Strain curvature(const StrainMeasure& m, const Positions& x) {
  Strain strain(m);
  const auto& at = m.normal;
  const Eigen::Vector3d p = place(m, at[1], x) - place(m, at[0], x);
  const Eigen::Vector3d q = place(m, at[3], x) - place(m, at[2], x);
  const Eigen::Vector3d normal = p.cross(q);
  const double area = normal.norm();
  if (area <= kTiny) return strain;
  const Eigen::Vector3d n = normal / area;
  const Eigen::Vector3d bend = sum(m, m.first, x);
  strain.value = bend.dot(n);
  add_weighted(m.first, n, strain);
  // The normal turns too: dn = (I − n nᵀ)(dp × q + p × dq)/|p × q|.
  const Eigen::Vector3d within = (bend - strain.value * n) / area;
  const Eigen::Vector3d of_p = q.cross(within), of_q = within.cross(p);
  strain.gradient.col(at[1]) += of_p;
  strain.gradient.col(at[0]) -= of_p;
  strain.gradient.col(at[3]) += of_q;
  strain.gradient.col(at[2]) -= of_q;
  return strain;
}

Strain strain_of(const StrainMeasure& m, const Positions& x) {
  if (m.kind == StrainMeasure::kCurvature) return curvature(m, x);
  Strain strain(m);
  add_length(m, m.first, 1.0, x, strain);
  if (!m.second.empty()) add_length(m, m.second, -1.0, x, strain);
  return strain;
}

}  // namespace

StrainDampingSet::StrainDampingSet(const std::vector<StrainMeasure>& strains, double time)
    : strains_(strains),
      time_(time),
      remembered_(strains.size(), 0.0),
      multipliers_(strains.size(), 0.0) {}

void StrainDampingSet::begin_step(const Particles& p) {
  const double share = p.inertia.is_used ? p.inertia.share : 0.0;
  Positions before;
  if (share > 0.0) before = p.x_start - p.history_before.moved;
  parallel_for(0, size(), kGrain, [&](int begin, int end) {
    for (int e = begin; e < end; ++e) {
      const auto at = static_cast<std::size_t>(e);
      const double now = strain_of(strains_[at], p.x_start).value;
      remembered_[at] =
          share > 0.0 ? now + share * (now - strain_of(strains_[at], before).value) : now;
    }
  });
}

double StrainDampingSet::energy(const Positions& x) const {
  return parallel_sum(0, size(), kSumGrain, [&](int e) {
    const auto at = static_cast<std::size_t>(e);
    const double change = strain_of(strains_[at], x).value - remembered_[at];
    return 0.5 * scale_ * strains_[at].stiffness * change * change;
  });
}

void StrainDampingSet::add_forces(const Positions& x, Forces& f) const {
  for (std::size_t e = 0; e < strains_.size(); ++e) {
    const StrainMeasure& m = strains_[e];
    const Strain strain = strain_of(m, x);
    const double tension = scale_ * m.stiffness * (strain.value - remembered_[e]);
    for (int k = 0; k < count_of(m); ++k) {
      f.col(m.particles[static_cast<std::size_t>(k)]) -= tension * strain.gradient.col(k);
    }
  }
}

void StrainDampingSet::add_to_system(SystemMatrix& a) const {
  for (const StrainMeasure& m : strains_) {
    // |∇(|u| − |v|)|² is at most twice the sum of both.
    const bool has_both = !m.second.empty();
    const double factor = (has_both ? 2.0 : 1.0) * scale_ * m.stiffness;
    for (std::size_t r = 0; r < m.particles.size(); ++r) {
      for (std::size_t c = 0; c < m.particles.size(); ++c) {
        double product = m.first[r] * m.first[c];
        if (has_both) product += m.second[r] * m.second[c];
        if (product != 0.0) a.add(m.particles[r], m.particles[c], factor * product);
      }
    }
  }
}

void StrainDampingSet::add_stiffness(const Positions& x, Definiteness, StiffnessMatrix& k) const {
  for (const StrainMeasure& m : strains_) {
    const Strain strain = strain_of(m, x);
    for (int r = 0; r < count_of(m); ++r) {
      for (int c = 0; c < count_of(m); ++c) {
        const Eigen::Matrix3d block =
            scale_ * m.stiffness * strain.gradient.col(r) * strain.gradient.col(c).transpose();
        k.add(m.particles[static_cast<std::size_t>(r)], m.particles[static_cast<std::size_t>(c)],
              block);
      }
    }
  }
}

void StrainDampingSet::reset_multipliers() {
  std::fill(multipliers_.begin(), multipliers_.end(), 0.0);
}

void StrainDampingSet::relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) {
  const double dt2 = dt * dt;
  for (std::size_t e = 0; e < strains_.size(); ++e) {
    const StrainMeasure& m = strains_[e];
    const Strain strain = strain_of(m, x);
    double mobility = 0.0;
    for (int k = 0; k < count_of(m); ++k) {
      mobility += inverse_mass[m.particles[static_cast<std::size_t>(k)]] *
                  strain.gradient.col(k).squaredNorm();
    }
    const double stiffness = scale_ * m.stiffness;
    const double delta = -(stiffness * (strain.value - remembered_[e]) + multipliers_[e]) /
                         (stiffness * dt2 * mobility + 1.0);
    multipliers_[e] += delta;
    for (int k = 0; k < count_of(m); ++k) {
      const int i = m.particles[static_cast<std::size_t>(k)];
      x.col(i) += dt2 * inverse_mass[i] * delta * strain.gradient.col(k);
    }
  }
}

}  // namespace pliant
