#include "pliant/solvers/checks/error_control.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {
// Of the asked error: below it, fewer iterations are tried.
constexpr double kFarBelow = 0.25;
// By how much at a time.
constexpr double kLeastMore = 1.25, kMostMore = 2.0, kFewer = 0.8;
// Of the asked error: the tolerances that are tried, since soft motions leave small residuals and
// large errors. With larger ones, a step in which something hits ends after its first iteration.
constexpr double kLeastTolerance = 1e-3, kMostTolerance = 1.0;
// The share of it that the next one aims at, and by how much one differs from the last.
constexpr double kAim = 0.5, kLeastStep = 0.1, kMostStep = 1.5;

}  // namespace

ErrorControl::ErrorControl(const StopRule& rule, By by) : by_(by), asked_(rule), first_(rule) {
  if (is_on() && by == By::kTolerance) {
    first_.tolerance = rule.error;
  }
  present_ = first_;
}

EndedBy ErrorControl::ended_by() const {
  return by_ == By::kTolerance ? EndedBy::kTolerance : EndedBy::kIterations;
}

bool ErrorControl::is_at_end() const {
  if (by_ == By::kTolerance) return present_.tolerance <= kLeastTolerance * asked_.error;
  return present_.iterations >= asked_.most_iterations;
}

void ErrorControl::learn_tolerance(double error) {
  // Errors grow with residuals, and not always in proportion.
  if (error <= asked_.error && error >= kFarBelow * asked_.error) return;
  const double factor = error > 0.0 ? kAim * asked_.error / error : kMostStep;
  present_.tolerance = std::clamp(std::clamp(factor, kLeastStep, kMostStep) * present_.tolerance,
                                  kLeastTolerance * asked_.error, kMostTolerance * asked_.error);
}

void ErrorControl::learn(double error, int iterations) {
  if (!is_on()) return;
  if (by_ == By::kTolerance) {
    learn_tolerance(error);
    return;
  }
  double factor = 1.0;
  // Errors of iterations without acceleration fall slowly: as many more as the error is too large.
  if (error > asked_.error) factor = std::clamp(error / asked_.error, kLeastMore, kMostMore);
  if (error < kFarBelow * asked_.error) factor = kFewer;
  const double next =
      factor > 1.0 ? std::ceil(factor * iterations) : std::floor(factor * iterations);
  present_.iterations = static_cast<int>(std::clamp(next, 1.0, double(asked_.most_iterations)));
}

void ErrorControl::load(StateArchive& numbers) {
  const double chosen = numbers.read();
  if (!is_on()) return;
  if (by_ == By::kTolerance) {
    if (chosen > 0.0 && chosen <= kMostTolerance * asked_.error) present_.tolerance = chosen;
  } else if (chosen >= 1.0) {
    present_.iterations = static_cast<int>(chosen);
  }
}

}  // namespace pliant
