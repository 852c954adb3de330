#pragma once

#include <cmath>

#include "pliant/math/host_device.h"

namespace pliant {

/// The spectral radius that a Chebyshev recurrence assumes, and what its own progress says of it.
/// Header only: CPU and GPU decide by one source.
class SpectralRadius {
 public:
  /// No estimate goes above `bound` < 1.
  PLIANT_HOST_DEVICE explicit SpectralRadius(double bound = 0.0) : bound_(bound) {}

  /// The ρ with which `n` iterations promise to leave a `share` of the error: T_n(1/ρ) = 1/share.
  static double that_leaves(double share, int n) {
    return 1.0 / std::cosh(std::acosh(1.0 / share) / n);
  }

  PLIANT_HOST_DEVICE void set(double value) {
    value_ = value < 0.0 ? 0.0 : (value > bound_ ? bound_ : value);
  }

  /// Error components beyond the assumed radius fall more slowly than the recurrence promises,
  /// 1/T_n(1/ρ). From `ratio`, by which the error changed in `n` accelerated iterations, follows
  /// the radius that explains it: ρ' = ρ cosh(acosh(ratio T_n(1/ρ))/n) (Hageman and Young 1981,
  /// section 5.4). It only rises.
  PLIANT_HOST_DEVICE void raise(double ratio, int n) {
    if (value_ <= 0.0 || n < 1 || !(ratio < kHuge)) return;
    const double amplification = std::log(ratio) + promise(n);
    if (!(amplification > 0.0)) return;
    // acosh(exp L).
    const double reached = amplification + std::log1p(std::sqrt(-std::expm1(-2.0 * amplification)));
    set(value_ * std::cosh(reached / n));
  }

  /// Whether the recurrence has promised enough to be judged and kept less than 3/4 of it (Hageman
  /// and Young's damping factor), in orders of magnitude.
  PLIANT_HOST_DEVICE bool lags(double ratio, int n) const {
    if (value_ <= 0.0 || n < 1 || !(ratio > 0.0)) return false;
    const double promised = promise(n);
    return promised > kEnoughToJudge && std::log(ratio) > -kDamping * promised;
  }

  /// Doubles the distance from 1.
  PLIANT_HOST_DEVICE void lower() { set(1.0 - 2.0 * (1.0 - value_)); }
  PLIANT_HOST_DEVICE double value() const { return value_; }

 private:
  static constexpr double kDamping = 0.75;
  static constexpr double kEnoughToJudge = 2.302585092994046;  // log 10
  static constexpr double kHuge = 1e300;

  /// log T_n(1/ρ).
  PLIANT_HOST_DEVICE double promise(int n) const {
    // T_n(z) = cosh(n acosh z) for z >= 1, which overflows early.
    const double exponent = n * std::acosh(1.0 / value_);
    return exponent + std::log1p(std::exp(-2.0 * exponent)) - 0.6931471805599453;
  }

  double bound_;
  double value_ = 0.0;
};

}  // namespace pliant
