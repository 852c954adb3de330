#pragma once

#include <cmath>

#include "pliant/laws/spectral_radius.h"

/// How accelerated iterations y → J(y) go on, by their changes |J(y) − y| in the norm of D. A
/// change that is noise, round-off of what it is the difference of, says nothing.
namespace pliant {

/// ω of Chebyshev's recurrence (Wang 2015, eq. 10).
template <typename T>
PLIANT_HOST_DEVICE inline T chebyshev_factor(T squared_radius, T last, bool is_first) {
  return is_first ? T(2) / (T(2) - squared_radius) : T(4) / (T(4) - squared_radius * last);
}

/// Nesterov's sequence t, 1 at first, and the share of its last step that an iteration goes on by.
struct NesterovStep {
  double next, share;
};
PLIANT_HOST_DEVICE inline NesterovStep nesterov_step(double t) {
  const double next = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * t * t));
  return {next, (t - 1.0) / next};
}

struct IterationChange {
  /// Growth that tells that iterations diverge: with momentum above the least change, in a
  /// recurrence above its first one. In the norm of D a recurrence with the right radius never lets
  /// it grow.
  static constexpr double kGrowth = 1.5;

  double change;
  bool is_noise;

  PLIANT_HOST_DEVICE bool has_grown_beyond(double earlier) const {
    return !is_noise && change > kGrowth * earlier;
  }
  /// Whether it is that of the best state so far. Of changes that are noise the smallest is no sign
  /// of that: later ones are.
  PLIANT_HOST_DEVICE bool is_best(double least) const { return is_noise || change <= least; }
  /// Whether the recurrence, `n` iterations after `first`, falls behind its promise.
  PLIANT_HOST_DEVICE bool lags(const SpectralRadius& radius, double first, int n) const {
    return !is_noise && radius.lags(change / first, n);
  }
};

}  // namespace pliant
