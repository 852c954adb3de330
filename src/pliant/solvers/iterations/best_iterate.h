#pragma once

#include <limits>
#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/core/system/point_constraint.h"

namespace pliant {

/// The best of a step's iterates in contact: the one that left least out of balance, with the
/// multipliers of its contacts. Those found with quasi-Newton corrections of a stiff body may grow
/// from iteration to iteration without an end, each within what its line search allows; then
/// iterations begin anew from here.
class BestIterate {
 public:
  void forget() { left_ = std::numeric_limits<double>::infinity(); }
  /// Keeps an iterate that leaves less than those before, `left` in any unit and `residual` as the
  /// step reports it.
  void offer(double left, double residual, const Positions& x, const PointConstraints& constraints);
  /// Whether what leaves so much went astray.
  bool is_far_better_than(double left) const { return left > kAstray * left_; }
  /// Sets the multipliers of `constraints`, those of the same step, and `x`.
  void restore(Positions& x, PointConstraints& constraints) const;
  double residual() const { return residual_; }

 private:
  // What an iteration leaves may rise for a while as contacts open and close.
  static constexpr double kAstray = 10.0;

  double left_ = std::numeric_limits<double>::infinity();
  double residual_ = 0.0;
  Positions x_;
  std::vector<PointConstraint> constraints_;
};

}  // namespace pliant
