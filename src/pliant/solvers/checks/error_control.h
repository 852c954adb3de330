#pragma once

#include "pliant/core/solver.h"

namespace pliant {

/// Chooses how far iterations go where a rule asks for an error: further while the estimated error
/// is above it, less far while it is far below. Without such a rule it is what the rule says.
class ErrorControl {
 public:
  /// What it chooses: how many iterations each step takes; or, for solvers whose iterations are few
  /// and costly, the residual down to which they go, so that each step takes as many as it needs,
  /// up to the rule's. Where the last iteration goes only a little below that, residuals are
  /// smaller, and steps that end before they reach theirs take more iterations too.
  enum class By { kIterations, kTolerance, kTightTolerance };

  explicit ErrorControl(const StopRule& rule, By by = By::kIterations);

  /// The residual that belongs to an error, over that error, from now on.
  void set_residual_share(double share);
  const StopRule& rule() const { return present_; }
  bool is_on() const { return asked_.error > 0.0; }
  /// Whether an asked error is missed by more than a factor of two.
  bool is_missed_by(double error) const { return is_on() && error > 2.0 * asked_.error; }
  /// What ends the iterations of a step as it chose.
  EndedBy ended_by() const;
  /// Whether nothing is left to choose where the error is too large.
  bool is_at_end() const;
  /// The error of a step that took `iterations` was estimated.
  void learn(double error, int iterations);

  /// Another run begins.
  void forget() { present_ = first_; }
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  void learn_iterations(double error, int iterations);
  void learn_tolerance(double error);
  /// The largest tolerance that it tries: never above the rule's own.
  double most_tolerance() const;
  /// Takes such a number of iterations, or the nearest that the rule allows.
  void take(double iterations, int least);

  double least_tolerance() const;

  By by_;
  StopRule asked_, first_, present_;
  double share_ = 1.0;
};

}  // namespace pliant
