#include "pliant/elements/solids/volume_set.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pliant/elements/solids/symmetric_function.h"
#include "pliant/elements/solids/volume_projection.h"
#include "pliant/math/error.h"
#include "pliant/math/rotation_batch.h"
#include "pliant/math/rotation_eigen.h"

namespace pliant {

template class SimplexSet<NearestVolumeLaw>;

namespace {

// Smallest over largest stretch above which the function of the stretches is smooth enough to be
// taken without their directions; flatter elements are rare.
constexpr double kRound = 0.25;

VolumeProjection project(const Eigen::Vector3d& sigma, const VolumeLimits& limits) {
  // The path from G to a nearest matrix crosses the nearer limit first.
  return project_to_volume(sigma, std::clamp(sigma.prod(), limits.min, limits.max));
}

bool allows(const VolumeLimits& limits, const PrincipalStretches& stretches) {
  const double volume = stretches.sigma.prod();
  return limits.min < volume && volume < limits.max;
}

void check(const VolumeLimits& limits) {
  if (limits.min > 0.0 && limits.max >= limits.min && std::isfinite(limits.max)) return;
  throw InputError(fmt::format("volume: limits {} to {} of the rest volume; needs 0 < min <= max",
                               limits.min, limits.max));
}

/// -μ U diag(1/p) Vᵀ, for any G.
Eigen::Matrix3d directed_stress(const Eigen::Matrix3d& g, const VolumeLimits& limits) {
  const PrincipalStretches stretches = principal_stretches(g);
  const VolumeProjection near = project(stretches.sigma, limits);
  return stretches.compose(-near.mu * near.p.cwiseInverse());
}

/// The same for G = R S with the stretches `sigma`.
Eigen::Matrix3d round_stress(const Eigen::Matrix3d& g, const Eigen::Matrix3d& r,
                             const Eigen::Matrix3d& s, const Eigen::Vector3d& sigma,
                             const VolumeLimits& limits) {
  const VolumeProjection near = project(sigma, limits);
  // With p² + μ > 0 all three p are the same function of their σ, of slope p²/(p² + μ).
  const Eigen::Vector3d c = near.p.array().square() + near.mu;
  if (!(c.minCoeff() > kRound * std::abs(near.mu))) return directed_stress(g, limits);
  return r *
         symmetric_function(s, sigma, -near.mu * near.p.cwiseInverse(), near.mu * c.cwiseInverse());
}

}  // namespace

void NearestVolumeLaw::stresses(const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const {
  Matrix3<double> f[kStressBlock] = {};
  Quaternion<double> q[kStressBlock];
  for (int k = 0; k < count; ++k) f[k] = to_plain(g[k]);
  nearest_rotations_cold(f, q, count);
  for (int k = 0; k < count; ++k) {
    // G - P = -μ U diag(1/p) Vᵀ = -μ R f(S) with G = R S, which keeps its digits near rest.
    const Eigen::Matrix3d r = to_eigen(q[k]).toRotationMatrix();
    const Eigen::Matrix3d rg = r.transpose() * g[k];
    const Eigen::Matrix3d s = 0.5 * (rg + rg.transpose());
    const Eigen::Vector3d sigma = symmetric_eigenvalues(s);
    p[k] = sigma[2] > kRound * sigma[0] ? round_stress(g[k], r, s, sigma, limits)
                                        : directed_stress(g[k], limits);
  }
}

Matrix9d NearestVolumeLaw::tangent(const Eigen::Matrix3d& g, Definiteness definiteness) const {
  const PrincipalStretches stretches = principal_stretches(g);
  const VolumeProjection projection = project(stretches.sigma, limits);
  if (allows(limits, stretches)) return Matrix9d::Zero();
  return distance_tangent(stretches, volume_slope(stretches.sigma, projection), definiteness);
}

VolumeSet::VolumeSet(const TetrahedralMesh& rest, double stiffness, const VolumeLimits& limits,
                     int first_particle)
    : VolumeSet(rest, Eigen::VectorXd::Constant(rest.tetrahedra.cols(), stiffness), limits,
                first_particle) {}

VolumeSet::VolumeSet(const TetrahedralMesh& rest, const Eigen::VectorXd& stiffness,
                     const VolumeLimits& limits, int first_particle)
    : SimplexSet("volume", make_tetrahedra("volume", rest, stiffness, first_particle), {limits}) {
  check(limits);
}

VolumeError VolumeSet::error(const Positions& x) const {
  VolumeError error;
  for (const Simplex<3>& tetrahedron : simplices().elements) {
    const double each = std::abs(tetrahedron.gradient(x).determinant() - 1.0);
    error.largest = std::max(error.largest, each);
    error.mean += each / size();
  }
  return error;
}

}  // namespace pliant
