#pragma once

#include "pliant/math/pi.h"
#include "pliant/math/vector3.h"

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
template <typename T>
class SphKernels {
 public:
  PLIANT_HOST_DEVICE constexpr explicit SphKernels(T support)
      : h_(support),
        h2_(support * support),
        poly6_(T(315) / (T(64) * T(kPi) * h2_ * h2_ * h2_ * h2_ * h_)),
        spiky_(T(15) / (T(kPi) * h2_ * h2_ * h2_)) {}

  PLIANT_HOST_DEVICE T support() const { return h_; }

  /// W = 315/(64 π H⁹) (H² − r²)³ [1/m³], smooth, for what is drawn or averaged.
  PLIANT_HOST_DEVICE T poly6(T r2) const {
    const T left = greater(T(0), h2_ - r2);
    return poly6_ * left * left * left;
  }
  /// dW/dr / r of poly6 [1/m⁵]: the gradient is that times the offset.
  PLIANT_HOST_DEVICE T poly6_slope(T r2) const {
    const T left = greater(T(0), h2_ - r2);
    return -T(6) * poly6_ * left * left;
  }
  /// W = 15/(π H⁶) (H − r)³ [1/m³], for density and pressure: its gradient does not vanish at the
  /// centre.
  PLIANT_HOST_DEVICE T spiky(T r) const {
    const T left = greater(T(0), h_ - r);
    return spiky_ * left * left * left;
  }
  /// dW/dr of spiky [1/m⁴], <= 0.
  PLIANT_HOST_DEVICE T spiky_slope(T r) const {
    const T left = greater(T(0), h_ - r);
    return -T(3) * spiky_ * left * left;
  }
  /// ∇²W = 45/(π H⁶) (H − r) of the viscosity kernel [1/m⁵], >= 0 everywhere.
  PLIANT_HOST_DEVICE T viscosity_laplacian(T r) const {
    return T(3) * spiky_ * greater(T(0), h_ - r);
  }

  // Integrals over the half space beyond a plane at distance d >= 0: what a wall adds.

  /// ∫ poly6 dV: 1/2 at d = 0, 0 from H on.
  PLIANT_HOST_DEVICE T poly6_beyond(T d) const {
    const auto primitive = [this](T z) {  // of (H² − z²)⁴
      const T z2 = z * z;
      return z * (h2_ * h2_ * h2_ * h2_ +
                  z2 * (-T(4) / T(3) * h2_ * h2_ * h2_ +
                        z2 * (T(6) / T(5) * h2_ * h2_ + z2 * (-T(4) / T(7) * h2_ + z2 / T(9)))));
    };
    return d >= h_ ? T(0) : T(0.25) * T(kPi) * poly6_ * (primitive(h_) - primitive(d));
  }
  /// ∫ spiky dV: 1/2 at d = 0, 0 from H on.
  PLIANT_HOST_DEVICE T spiky_beyond(T d) const {
    const T u = greater(T(0), h_ - d), u2 = u * u;
    return T(2) * T(kPi) * spiky_ * u2 * u2 * u * (h_ / T(20) - u / T(30));
  }
  /// |∫ ∇ poly6 dV|, along the plane's normal [1/m].
  PLIANT_HOST_DEVICE T poly6_push_beyond(T d) const {
    const T left = greater(T(0), h2_ - d * d), left2 = left * left;
    return T(0.25) * T(kPi) * poly6_ * left2 * left2;
  }
  /// |∫ ∇ spiky dV|, along the plane's normal [1/m].
  PLIANT_HOST_DEVICE T spiky_push_beyond(T d) const {
    const T u = greater(T(0), h_ - d), u2 = u * u;
    return T(2) * T(kPi) * spiky_ * u2 * u2 * (T(0.25) * h_ - T(0.2) * u);
  }
  /// ∫ ∇²W z/d dV of the viscosity kernel, z the distance along the normal [1/m²]: by which a wall
  /// slows what slips on it, where the velocity goes on linearly beyond the wall.
  PLIANT_HOST_DEVICE T viscosity_drag_beyond(T d) const {
    const T u = greater(T(0), h_ - d), u3 = u * u * u;
    return T(6) * T(kPi) * spiky_ * u3 * (h2_ / T(6) + u * (-T(5) / T(24) * h_ + u / T(15))) / d;
  }

 private:
  T h_, h2_, poly6_, spiky_;
};

}  // namespace pliant
