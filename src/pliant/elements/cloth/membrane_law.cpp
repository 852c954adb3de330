#include "pliant/elements/cloth/membrane_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"

namespace pliant {
namespace {

// A shorter vector has no direction; rest lengths are 1.
constexpr double kTinyLength = 1e-150;
const double kHalfRoot = std::sqrt(0.5);

double length(const Eigen::Vector3d& a) { return std::max(a.norm(), kTinyLength); }

/// dΨ/d|a| of the terms of one yarn.
double tension(double length, double stiffness, double limit, const StretchLimits& limits) {
  const double beyond = length - std::clamp(length, limits.min, limits.max);
  return stiffness * (length - 1.0) + limit * beyond;
}

/// Along n with `along`, across it with `across`.
Eigen::Matrix3d block(const Eigen::Vector3d& n, double along, double across) {
  return across * Eigen::Matrix3d::Identity() + (along - across) * n * n.transpose();
}

Eigen::Matrix3d yarn_tangent(const Eigen::Vector3d& a, double stiffness, double limit,
                             const StretchLimits& limits, Definiteness definiteness) {
  const double l = length(a);
  if (l <= kTinyLength) return Eigen::Matrix3d::Zero();
  const bool beyond = l < limits.min || l > limits.max;
  double across = tension(l, stiffness, limit, limits) / l;
  if (definiteness == Definiteness::kProjected) across = std::max(across, 0.0);
  return block(a / l, stiffness + (beyond ? limit : 0.0), across);
}

/// Of 1/2 k (|u| - |v|)², over (u, v).
Eigen::Matrix<double, 6, 6> shear_tangent(const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                                          double stiffness, Definiteness definiteness) {
  const double lu = length(u), lv = length(v);
  const Eigen::Vector3d nu = u / lu, nv = v / lv;
  double across_u = lu > kTinyLength ? 1.0 - lv / lu : 0.0;
  double across_v = lv > kTinyLength ? 1.0 - lu / lv : 0.0;
  if (definiteness == Definiteness::kProjected) {
    across_u = std::max(across_u, 0.0);
    across_v = std::max(across_v, 0.0);
  }
  Eigen::Matrix<double, 6, 6> tangent;
  tangent << block(nu, 1.0, across_u), -nu * nv.transpose(),  //
      -nv * nu.transpose(), block(nv, 1.0, across_v);
  return stiffness * tangent;
}

Gradient<2> stress_of(const Gradient<2>& g, const MembraneMaterial& m) {
  Gradient<2> stress;
  const double la = length(g.col(0)), lb = length(g.col(1));
  stress.col(0) = tension(la, m.warp, m.limit, m.warp_limits) / la * g.col(0);
  stress.col(1) = tension(lb, m.weft, m.limit, m.weft_limits) / lb * g.col(1);
  // With u, v = (a ± b)/√2: k (|u| - |v|) (û, -v̂), turned back.
  const Eigen::Vector3d u = kHalfRoot * (g.col(0) + g.col(1));
  const Eigen::Vector3d v = kHalfRoot * (g.col(0) - g.col(1));
  const double lu = length(u), lv = length(v);
  const double difference = kHalfRoot * m.shear * (lu - lv);
  stress.col(0) += difference * (u / lu - v / lv);
  stress.col(1) += difference * (u / lu + v / lv);
  return stress;
}

double energy_of(const Gradient<2>& g, const MembraneMaterial& m) {
  const auto yarn = [&](const Eigen::Vector3d& a, double stiffness, const StretchLimits& limits) {
    const double l = a.norm();
    const double beyond = l - std::clamp(l, limits.min, limits.max);
    return 0.5 * (stiffness * (l - 1.0) * (l - 1.0) + m.limit * beyond * beyond);
  };
  const double diagonals =
      kHalfRoot * ((g.col(0) + g.col(1)).norm() - (g.col(0) - g.col(1)).norm());
  return yarn(g.col(0), m.warp, m.warp_limits) + yarn(g.col(1), m.weft, m.weft_limits) +
         0.5 * m.shear * diagonals * diagonals;
}

}  // namespace

void check(const std::string& name, const MembraneMaterial& material) {
  const auto check_one = [&](const char* field, double value) {
    if (std::isfinite(value) && value >= 0.0) return;
    throw InputError(
        fmt::format("{}: {} is {} N/m, but must be at least 0 and finite", name, field, value));
  };
  check_one("warp", material.warp);
  check_one("weft", material.weft);
  check_one("shear", material.shear);
  check_one("limit", material.limit);
  if (material.warp + material.weft + material.shear + material.limit == 0.0) {
    throw InputError(name + ": warp, weft, shear and limit are all 0; give one of them");
  }
  check(name + " warp", material.warp_limits);
  check(name + " weft", material.weft_limits);
}

void MembraneLaw::energies(const Gradient<2>* g, int count, double* energy) const {
  for (int k = 0; k < count; ++k) energy[k] = energy_of(g[k], material);
}

void MembraneLaw::stresses(const Gradient<2>* g, int count, Gradient<2>* p) const {
  for (int k = 0; k < count; ++k) p[k] = stress_of(g[k], material);
}

Eigen::Matrix<double, 6, 6> MembraneLaw::tangent(const Gradient<2>& g,
                                                 Definiteness definiteness) const {
  const auto& m = material;
  const Eigen::Vector3d u = kHalfRoot * (g.col(0) + g.col(1));
  const Eigen::Vector3d v = kHalfRoot * (g.col(0) - g.col(1));
  const Eigen::Matrix3d i = kHalfRoot * Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 6, 6> turn;  // (u, v) from (a, b)
  turn << i, i, i, -i;
  Eigen::Matrix<double, 6, 6> tangent =
      turn.transpose() * shear_tangent(u, v, m.shear, definiteness) * turn;
  tangent.topLeftCorner<3, 3>() +=
      yarn_tangent(g.col(0), m.warp, m.limit, m.warp_limits, definiteness);
  tangent.bottomRightCorner<3, 3>() +=
      yarn_tangent(g.col(1), m.weft, m.limit, m.weft_limits, definiteness);
  return tangent;
}

Eigen::Vector2d MembraneLaw::bound() const {
  // The shear term is k_s times a squared distance, not half of it.
  const double both = material.limit + 2.0 * material.shear;
  return {material.warp + both, material.weft + both};
}

}  // namespace pliant
