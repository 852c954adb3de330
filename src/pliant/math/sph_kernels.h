#pragma once

#include <algorithm>

#include "pliant/math/pi.h"

namespace pliant {

/// Sums over particles at half a support's distance pass integrals, or fall short of them: Σ V W of
/// spiky, the particle's own share included, makes so much of 1 in liquid at rest (in the more even
/// samples that it starts from 1.233) and, where the liquid is squeezed, grows by so much of the
/// density's growth; Σ V r²/6 ∇²W of the viscosity kernel is less than 1, too. Measured; see the
/// tests Liquid.AColumnAtRestHasHydrostaticPressure and InteriorSamples.
constexpr double kSphBulk = 1.25;
constexpr double kSphSlope = 0.80;
constexpr double kSphLaplacian = 0.966;

/// The smoothing kernels of Müller et al. 2003, "Particle-based fluid simulation for interactive
/// applications", for one support radius H [m]: zero from r = H on, and of integral 1 over space.
/// r is a distance >= 0 [m].
class SphKernels {
 public:
  explicit SphKernels(double support)
      : h_(support),
        h2_(support * support),
        poly6_(315.0 / (64.0 * kPi * h2_ * h2_ * h2_ * h2_ * h_)),
        spiky_(15.0 / (kPi * h2_ * h2_ * h2_)) {}

  double support() const { return h_; }

  /// W = 315/(64 π H⁹) (H² − r²)³ [1/m³], smooth, for what is drawn or averaged.
  double poly6(double r2) const {
    const double left = std::max(0.0, h2_ - r2);
    return poly6_ * left * left * left;
  }
  /// dW/dr / r of poly6 [1/m⁵]: the gradient is that times the offset.
  double poly6_slope(double r2) const {
    const double left = std::max(0.0, h2_ - r2);
    return -6.0 * poly6_ * left * left;
  }
  /// W = 15/(π H⁶) (H − r)³ [1/m³], for density and pressure: its gradient does not vanish at the
  /// centre.
  double spiky(double r) const {
    const double left = std::max(0.0, h_ - r);
    return spiky_ * left * left * left;
  }
  /// dW/dr of spiky [1/m⁴], <= 0.
  double spiky_slope(double r) const {
    const double left = std::max(0.0, h_ - r);
    return -3.0 * spiky_ * left * left;
  }
  /// ∇²W = 45/(π H⁶) (H − r) of the viscosity kernel [1/m⁵], >= 0 everywhere.
  double viscosity_laplacian(double r) const { return 3.0 * spiky_ * std::max(0.0, h_ - r); }

  // Integrals over the half space beyond a plane at distance d >= 0: what a wall adds.

  /// ∫ poly6 dV: 1/2 at d = 0, 0 from H on.
  double poly6_beyond(double d) const {
    const auto primitive = [this](double z) {  // of (H² − z²)⁴
      const double z2 = z * z;
      return z * (h2_ * h2_ * h2_ * h2_ +
                  z2 * (-4.0 / 3.0 * h2_ * h2_ * h2_ +
                        z2 * (6.0 / 5.0 * h2_ * h2_ + z2 * (-4.0 / 7.0 * h2_ + z2 / 9.0))));
    };
    return d >= h_ ? 0.0 : 0.25 * kPi * poly6_ * (primitive(h_) - primitive(d));
  }
  /// ∫ spiky dV: 1/2 at d = 0, 0 from H on.
  double spiky_beyond(double d) const {
    const double u = std::max(0.0, h_ - d), u2 = u * u;
    return 2.0 * kPi * spiky_ * u2 * u2 * u * (h_ / 20.0 - u / 30.0);
  }
  /// |∫ ∇ poly6 dV|, along the plane's normal [1/m].
  double poly6_push_beyond(double d) const {
    const double left = std::max(0.0, h2_ - d * d), left2 = left * left;
    return 0.25 * kPi * poly6_ * left2 * left2;
  }
  /// |∫ ∇ spiky dV|, along the plane's normal [1/m].
  double spiky_push_beyond(double d) const {
    const double u = std::max(0.0, h_ - d), u2 = u * u;
    return 2.0 * kPi * spiky_ * u2 * u2 * (0.25 * h_ - 0.2 * u);
  }
  /// ∫ ∇²W z/d dV of the viscosity kernel, z the distance along the normal [1/m²]: by which a wall
  /// slows what slips on it, where the velocity goes on linearly beyond the wall.
  double viscosity_drag_beyond(double d) const {
    const double u = std::max(0.0, h_ - d), u3 = u * u * u;
    return 6.0 * kPi * spiky_ * u3 * (h2_ / 6.0 + u * (-5.0 / 24.0 * h_ + u / 15.0)) / d;
  }

 private:
  double h_, h2_, poly6_, spiky_;
};

}  // namespace pliant
