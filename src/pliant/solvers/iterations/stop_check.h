#pragma once

#include "pliant/core/solver.h"
#include "pliant/core/step/timer.h"

namespace pliant {

/// Counts iterations and says when to stop and why.
class StopCheck {
 public:
  StopCheck(const StopRule& rule, StepReport& report)
      : rule_(rule), report_(report), most_(rule.iterations) {}

  /// True while another iteration is due; counts it.
  bool next();
  /// Whether the caller has to measure the residual of the running iteration: the first, also the
  /// second where there are `constraints`, for its scale; the last for the report.
  bool wants_residual(bool constraints) const {
    return rule_.tolerance > 0.0 || report_.iterations <= (constraints ? 2 : 1) ||
           report_.iterations == most_;
  }
  /// The relative residual at the beginning of the running iteration. Returns true when it is small
  /// enough: the iteration is then not needed and not counted.
  bool converged(double residual);
  /// Whether a solver that ends where only round-off is left should look at the residual now: in
  /// the 2nd, 4th, 8th, ... iteration.
  bool may_be_round_off() const {
    return report_.iterations > 1 && (report_.iterations & (report_.iterations - 1)) == 0;
  }
  /// Ends the iterations: only round-off was left when the running one began, which is not counted.
  void end_at_round_off() {
    --report_.iterations;
    report_.ended_by = EndedBy::kRoundOff;
  }
  /// As many more as the rule says: there is more to answer than what they began with. False where
  /// the time is over, or that was said too often.
  bool go_on();
  /// Round-off stops further progress.
  void stall() { stalled_ = true; }
  /// Whether the iterations ended without a look at the residual of the last one.
  bool is_residual_old() const { return measured_ < report_.iterations; }
  void set_residual(double residual) { report_.residual = residual; }
  /// Once the iterations have ended: warns where the asked tolerance was not reached.
  void warn_unless_converged() const;
  /// Warns of a large residual that nobody asked for, where nothing estimates the error.
  void warn_of_large_residual() const;

 private:
  const StopRule& rule_;
  StepReport& report_;
  Timer timer_;
  bool stalled_ = false;
  int most_;          // iterations, those that were gone on with among them
  int gone_on_ = 0;   // how many times
  int measured_ = 0;  // the last iteration whose residual is known
};

}  // namespace pliant
