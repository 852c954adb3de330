#pragma once

#include "pliant/core/solver.h"

namespace pliant {

/// Chooses how many iterations a step takes where a rule asks for an error: more of them while the
/// estimated error is above it, fewer while it is far below. Without such a rule it is what the
/// rule says.
class ErrorControl {
 public:
  explicit ErrorControl(const StopRule& rule) : asked_(rule), present_(rule) {}

  const StopRule& rule() const { return present_; }
  bool is_on() const { return asked_.error > 0.0; }
  /// Whether an asked error is missed by more than a factor of two.
  bool is_missed_by(double error) const { return is_on() && error > 2.0 * asked_.error; }
  /// The error of a step that took `iterations` was estimated.
  void learn(double error, int iterations);

  /// Another run begins.
  void forget() { present_ = asked_; }
  void save(StateArchive& numbers) const { numbers.write(present_.iterations); }
  void load(StateArchive& numbers);

 private:
  StopRule asked_, present_;
};

}  // namespace pliant
