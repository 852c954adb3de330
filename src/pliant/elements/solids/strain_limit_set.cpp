#include "pliant/elements/solids/strain_limit_set.h"

#include <Eigen/LU>
#include <algorithm>

#include "pliant/elements/solids/principal_stretches.h"
#include "pliant/elements/solids/symmetric_function.h"

namespace pliant {

template class SimplexSet<StretchLimitLaw>;

namespace {

/// Surely within the limits, told without a decomposition: the eigenvalues of GᵀG differ from 1 by
/// no more than the norm of GᵀG - I.
bool surely_within(const Eigen::Matrix3d& g, const StretchLimits& limits) {
  const double deviation = (g.transpose() * g - Eigen::Matrix3d::Identity()).norm();
  return deviation < 1.0 - limits.min * limits.min && deviation < limits.max * limits.max - 1.0 &&
         g.determinant() > 0.0;
}

StretchSlope clamp_slope(const Eigen::Vector3d& sigma, const Eigen::Vector3d& p) {
  const auto inside = [&](int k) { return p[k] == sigma[k] ? 1.0 : 0.0; };
  StretchSlope slope;
  slope.stretch = Eigen::Vector3d(inside(0), inside(1), inside(2)).asDiagonal();
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double gap = sigma[i] - sigma[j];
    slope.flip[k] = gap != 0.0 ? (p[i] - p[j]) / gap : inside(i);
  }
  slope.twist = twist_slopes(sigma, p);
  return slope;
}

/// G - P(G).
Eigen::Matrix3d beyond(const Eigen::Matrix3d& g, const StretchLimits& limits) {
  if (surely_within(g, limits)) return Eigen::Matrix3d::Zero();
  const PrincipalStretches stretches = principal_stretches(g);
  const Eigen::Vector3d& sigma = stretches.sigma;
  // NaN comes through: max and min keep their first argument then.
  const Eigen::Vector3d p =
      sigma.unaryExpr([&](double s) { return std::min(std::max(s, limits.min), limits.max); });
  return stretches.compose(sigma - p);
}

}  // namespace

void StretchLimitLaw::stresses(const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const {
  for (int k = 0; k < count; ++k) p[k] = beyond(g[k], limits);
}

Matrix9d StretchLimitLaw::tangent(const Eigen::Matrix3d& g, Definiteness definiteness) const {
  if (surely_within(g, limits)) return Matrix9d::Zero();
  const PrincipalStretches stretches = principal_stretches(g);
  const Eigen::Vector3d p = stretches.sigma.cwiseMax(limits.min).cwiseMin(limits.max);
  return distance_tangent(stretches, clamp_slope(stretches.sigma, p), definiteness);
}

StrainLimitSet::StrainLimitSet(const TetrahedralMesh& rest, double stiffness,
                               const StretchLimits& limits, int first_particle)
    : SimplexSet("strain_limit",
                 make_tetrahedra("strain_limit", rest,
                                 Eigen::VectorXd::Constant(rest.tetrahedra.cols(), stiffness),
                                 first_particle),
                 {limits}) {
  check("strain_limit", limits);
}

double StrainLimitSet::largest_strain(const Positions& x) const {
  double largest = 0.0;
  for (const Simplex<3>& tetrahedron : simplices().elements) {
    const Eigen::Matrix3d g = tetrahedron.gradient(x);
    const Eigen::Vector3d sigma =
        symmetric_eigenvalues(g.transpose() * g).cwiseMax(0.0).cwiseSqrt();
    const double least = g.determinant() < 0.0 ? -sigma[2] : sigma[2];
    largest = std::max({largest, sigma[0] - 1.0, 1.0 - least});
  }
  return largest;
}

}  // namespace pliant
