#include "pliant/elements/cloth/stretch_laws.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "pliant/elements/solids/simplex_set.h"
#include "pliant/math/rotation_batch.h"
#include "pliant/math/rotation_eigen.h"

namespace pliant {
namespace {

using Matrix93d = Eigen::Matrix<double, 9, 3>;
using Vector9d = Eigen::Matrix<double, 9, 1>;

/// Slopes of the nearest rotation: along the twist (uᵢ vⱼᵀ − uⱼ vᵢᵀ)/√2 it turns by 2/(σᵢ + σⱼ) of
/// that. Columns are twists times the root of their slope, times `stretch` from the right.
Matrix93d twists(const PrincipalStretches& a, const Eigen::Matrix3d& stretch) {
  const Eigen::Vector3d slopes = twist_slopes(a.sigma, Eigen::Vector3d::Ones());
  Matrix93d result;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Eigen::Matrix3d twist =
        (a.u.col(i) * a.v.col(j).transpose() - a.u.col(j) * a.v.col(i).transpose()) * stretch;
    result.col(k) = std::sqrt(0.5 * slopes[k]) * Eigen::Map<const Vector9d>(twist.data());
  }
  return result;
}

/// I − W Wᵀ, without its negative eigenvalues where that is asked for.
Matrix9d one_less(const Matrix93d& w, Definiteness definiteness) {
  Matrix9d result = Matrix9d::Identity() - w * w.transpose();
  if (definiteness == Definiteness::kExact) return result;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(w.transpose() * w);
  for (int k = 0; k < 3; ++k) {
    const double beyond = eigen.eigenvalues()[k] - 1.0;
    if (beyond <= 0.0) continue;
    const Vector9d direction = (w * eigen.eigenvectors().col(k)).normalized();
    result += beyond * direction * direction.transpose();
  }
  return result;
}

/// Calls use(k, R) for the rotations R nearest to the matrices stretched(k).
template <class Stretched, class Use>
void for_rotations(int count, const Stretched& stretched, const Use& use) {
  Matrix3<double> f[kStressBlock] = {};
  Quaternion<double> q[kStressBlock];
  for (int k = 0; k < count; ++k) f[k] = to_plain(stretched(k));
  nearest_rotations_cold(f, q, count);
  for (int k = 0; k < count; ++k) use(k, to_eigen(q[k]).toRotationMatrix());
}

Eigen::Matrix3d stretch_of(const Eigen::Matrix3d& g) {
  const Eigen::Matrix3d s = nearest_rotation(g).toRotationMatrix().transpose() * g;
  return 0.5 * (s + s.transpose());
}

/// Σσ − 3
double sum_of(const Eigen::Matrix3d& g) {
  const Eigen::Matrix3d r = nearest_rotation(g).toRotationMatrix();
  return r.cwiseProduct(g - r).sum();
}

}  // namespace

void ShearLaw::stresses(int first, const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const {
  if (remembered.empty()) {
    for_rotations(
        count, [&](int k) { return g[k]; },
        [&](int k, const Eigen::Matrix3d& r) { p[k] = 2.0 * (g[k] - r); });
    return;
  }
  const Eigen::Matrix3d* u = remembered.data() + first;
  for_rotations(
      count, [&](int k) -> Eigen::Matrix3d { return g[k] * u[k]; },
      [&](int k, const Eigen::Matrix3d& r) { p[k] = 2.0 * (g[k] - r * u[k]); });
}

Matrix9d ShearLaw::tangent(int part, const Eigen::Matrix3d& g, Definiteness definiteness) const {
  const Eigen::Matrix3d u =
      remembered.empty() ? Eigen::Matrix3d::Identity() : remembered[static_cast<std::size_t>(part)];
  return 2.0 * one_less(twists(principal_stretches(g * u), u), definiteness);
}

void ShearLaw::remember(int part, const Eigen::Matrix3d& g) {
  remembered[static_cast<std::size_t>(part)] = stretch_of(g);
}

void ShearLaw::remember(int part, const Eigen::Matrix3d& g, const Eigen::Matrix3d& before,
                        double share) {
  const Eigen::Matrix3d u = stretch_of(g);
  remembered[static_cast<std::size_t>(part)] = u + share * (u - stretch_of(before));
}

void PressureLaw::stresses(int first, const Eigen::Matrix3d* g, int count,
                           Eigen::Matrix3d* p) const {
  for_rotations(
      count, [&](int k) { return g[k]; },
      [&](int k, const Eigen::Matrix3d& r) {
        const double s = remembered.empty() ? 0.0 : remembered[static_cast<std::size_t>(first + k)];
        p[k] = (r.cwiseProduct(g[k] - r).sum() - s) * r;
      });
}

Matrix9d PressureLaw::tangent(int part, const Eigen::Matrix3d& g, Definiteness definiteness) const {
  const PrincipalStretches stretches = principal_stretches(g);
  const Eigen::Matrix3d r = stretches.u * stretches.v.transpose();
  const Eigen::Map<const Vector9d> along(r.data());
  const double s = remembered.empty() ? 0.0 : remembered[static_cast<std::size_t>(part)];
  double across = stretches.sigma.sum() - 3.0 - s;
  if (definiteness == Definiteness::kProjected) across = std::max(across, 0.0);
  const Matrix93d w = twists(stretches, Eigen::Matrix3d::Identity());
  return along * along.transpose() + across * w * w.transpose();
}

void PressureLaw::remember(int part, const Eigen::Matrix3d& g) {
  remembered[static_cast<std::size_t>(part)] = sum_of(g);
}

void PressureLaw::remember(int part, const Eigen::Matrix3d& g, const Eigen::Matrix3d& before,
                           double share) {
  const double s = sum_of(g);
  remembered[static_cast<std::size_t>(part)] = s + share * (s - sum_of(before));
}

}  // namespace pliant
