#include "pliant/elements/volume_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/elements/volume_projection.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

struct Projected {
  PrincipalStretches stretches;
  VolumeProjection projection;
};

Projected project(const Eigen::Matrix3d& g, const VolumeLimits& limits) {
  Projected result;
  result.stretches = principal_stretches(g);
  const Eigen::Vector3d& sigma = result.stretches.sigma;
  // The way from G to a nearest matrix crosses the nearer limit first.
  const double volume = std::clamp(sigma.prod(), limits.min, limits.max);
  result.projection = project_to_volume(sigma, volume);
  return result;
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

}  // namespace

void NearestVolumeLaw::stresses(const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const {
  for (int k = 0; k < count; ++k) {
    // G - P = -μ U diag(1/p) Vᵀ, which keeps its digits near rest.
    const auto [stretches, projection] = project(g[k], limits);
    p[k] = stretches.compose(-projection.mu * projection.p.cwiseInverse());
  }
}

Matrix9d NearestVolumeLaw::tangent(const Eigen::Matrix3d& g, Definiteness definiteness) const {
  const auto [stretches, projection] = project(g, limits);
  if (allows(limits, stretches)) return Matrix9d::Zero();
  return distance_tangent(stretches, volume_slope(stretches.sigma, projection), definiteness);
}

VolumeSet::VolumeSet(const TetrahedralMesh& rest, double stiffness, const VolumeLimits& limits)
    : VolumeSet(rest, Eigen::VectorXd::Constant(rest.tetrahedra.cols(), stiffness), limits) {}

VolumeSet::VolumeSet(const TetrahedralMesh& rest, const Eigen::VectorXd& stiffness,
                     const VolumeLimits& limits)
    : SimplexSet("volume", make_tetrahedra("volume", rest, stiffness), {limits}) {
  check(limits);
}

}  // namespace pliant
