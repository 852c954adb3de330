#include "pliant/solvers/iterations/stop_check.h"

#include <algorithm>

namespace pliant {
namespace {
// Above this share of unbalanced forces a result says little, whatever the user asked for.
constexpr double kLargeResidual = 0.5;
constexpr double kRoundOffResidual = 1e-6;
// Bodies that come to touch others, which come to touch others, in one step.
constexpr int kMostGoneOn = 4;
}  // namespace

bool StopCheck::next() {
  if (stalled_) {
    report_.ended_by = EndedBy::kRoundOff;
    return false;
  }
  if (report_.iterations >= most_) {
    report_.ended_by = EndedBy::kIterations;
    return false;
  }
  if (rule_.budget > 0.0 && report_.iterations > 0 && timer_.seconds() > rule_.budget) {
    report_.ended_by = EndedBy::kBudget;
    return false;
  }
  ++report_.iterations;
  return true;
}

bool StopCheck::go_on() {
  if (report_.ended_by == EndedBy::kBudget || gone_on_ == kMostGoneOn) return false;
  ++gone_on_;
  most_ = report_.iterations + rule_.iterations;
  stalled_ = false;
  return true;
}

bool StopCheck::converged(double residual) {
  report_.residual = residual;
  measured_ = report_.iterations;
  if (rule_.tolerance <= 0.0 || !(residual <= rule_.tolerance)) return false;
  --report_.iterations;
  report_.ended_by = EndedBy::kTolerance;
  return true;
}

void StopCheck::warn_unless_converged() const {
  // No iteration betters what round-off leaves; more than this it does not leave.
  const double least = report_.ended_by == EndedBy::kRoundOff ? kRoundOffResidual : 0.0;
  if (rule_.tolerance <= 0.0 || report_.residual <= std::max(rule_.tolerance, least)) return;
  report_.warn(
      "not_converged: the asked tolerance was not reached: take more iterations, a smaller time "
      "step, or a solver that converges faster here (`pliant study advise` names it)");
}

void StopCheck::warn_of_large_residual() const {
  if (rule_.tolerance > 0.0 || report_.residual <= kLargeResidual) return;
  report_.warn(
      "not_converged: the iterations left a large residual: take more of them, a smaller time "
      "step, or a solver that converges faster here (`pliant study advise` names it)");
}

}  // namespace pliant
