#include "pliant/elements/cloth/membrane_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/laws/membrane.h"
#include "pliant/math/error.h"
#include "pliant/math/vector_traits_eigen.h"

namespace pliant {
namespace {

const double kHalfRoot = std::sqrt(0.5);

MembraneConstants<double> constants_of(const MembraneMaterial& m) {
  return {m.warp,
          m.weft,
          m.shear,
          m.limit,
          m.warp_limits.min,
          m.warp_limits.max,
          m.weft_limits.min,
          m.weft_limits.max};
}

/// Along n with `along`, across it with `across`.
Eigen::Matrix3d block(const Eigen::Vector3d& n, double along, double across) {
  return across * Eigen::Matrix3d::Identity() + (along - across) * n * n.transpose();
}

Eigen::Matrix3d yarn_tangent(const Eigen::Vector3d& a, double stiffness, double limit,
                             const StretchLimits& limits, Definiteness definiteness) {
  const double l = divisor_of(a);
  if (l <= kNoDirection<double>) return Eigen::Matrix3d::Zero();
  const bool beyond = l < limits.min || l > limits.max;
  double across = yarn_tension(l, stiffness, limit, limits.min, limits.max) / l;
  if (definiteness == Definiteness::kProjected) across = std::max(across, 0.0);
  return block(a / l, stiffness + (beyond ? limit : 0.0), across);
}

/// Of 1/2 k (|u| - |v|)², over (u, v).
Eigen::Matrix<double, 6, 6> shear_tangent(const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                                          double stiffness, Definiteness definiteness) {
  const double lu = divisor_of(u), lv = divisor_of(v);
  const Eigen::Vector3d nu = u / lu, nv = v / lv;
  double across_u = lu > kNoDirection<double> ? 1.0 - lv / lu : 0.0;
  double across_v = lv > kNoDirection<double> ? 1.0 - lu / lv : 0.0;
  if (definiteness == Definiteness::kProjected) {
    across_u = std::max(across_u, 0.0);
    across_v = std::max(across_v, 0.0);
  }
  Eigen::Matrix<double, 6, 6> tangent;
  tangent << block(nu, 1.0, across_u), -nu * nv.transpose(),  //
      -nv * nu.transpose(), block(nv, 1.0, across_v);
  return stiffness * tangent;
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
  const MembraneConstants<double> constants = constants_of(material);
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d warp = g[k].col(0), weft = g[k].col(1);
    const auto stress = membrane_stress(warp, weft, constants);
    p[k].col(0) = stress.along_warp;
    p[k].col(1) = stress.along_weft;
  }
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
