#pragma once

namespace pliant {

/// The spectral radius that a Chebyshev recurrence assumes, and what its own progress says of it.
class SpectralRadius {
 public:
  /// No estimate goes above `bound` < 1.
  explicit SpectralRadius(double bound = 0.0) : bound_(bound) {}

  /// The ρ with which `n` iterations promise to leave a `share` of the error: T_n(1/ρ) = 1/share.
  static double that_leaves(double share, int n);
  void set(double value);
  /// Error components beyond the assumed radius fall more slowly than the recurrence promises,
  /// 1/T_n(1/ρ). From `ratio`, by which the error changed in `n` accelerated iterations, follows
  /// the radius that explains it: ρ' = ρ cosh(acosh(ratio T_n(1/ρ))/n) (Hageman and Young 1981,
  /// section 5.4). It only rises.
  void raise(double ratio, int n);
  /// Whether the recurrence has promised enough to be judged and kept less than 3/4 of it (Hageman
  /// and Young's damping factor), in orders of magnitude.
  bool lags(double ratio, int n) const;
  /// Doubles the distance from 1.
  void lower();
  double value() const { return value_; }

 private:
  /// log T_n(1/ρ).
  double promise(int n) const;

  double bound_;
  double value_ = 0.0;
};

}  // namespace pliant
