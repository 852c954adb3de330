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
constexpr double kLeastTolerance = 1e-3, kMostTolerance = 1.0, kMostTightTolerance = 0.3;
// The share of it that the next one aims at, and by how much one differs from the last.
constexpr double kAim = 0.5, kLeastStep = 0.1, kMostStep = 1.5;

}  // namespace

ErrorControl::ErrorControl(const StopRule& rule, By by) : by_(by), asked_(rule), first_(rule) {
  if (is_on() && by != By::kIterations) first_.tolerance = most_tolerance();
  present_ = first_;
}

double ErrorControl::most_tolerance() const {
  const double share = by_ == By::kTightTolerance ? kMostTightTolerance : kMostTolerance;
  const double most = share * share_ * asked_.error;
  return asked_.tolerance > 0.0 ? std::min(most, asked_.tolerance) : most;
}

double ErrorControl::least_tolerance() const { return kLeastTolerance * share_ * asked_.error; }

void ErrorControl::set_residual_share(double share) {
  share_ = share;
  if (!is_on() || by_ == By::kIterations) return;
  first_.tolerance = most_tolerance();
  present_.tolerance = std::min(present_.tolerance, first_.tolerance);
}

EndedBy ErrorControl::ended_by() const {
  return by_ == By::kIterations ? EndedBy::kIterations : EndedBy::kTolerance;
}

bool ErrorControl::is_at_end() const {
  const bool are_most = present_.iterations >= asked_.most_iterations;
  const bool is_least = present_.tolerance <= least_tolerance();
  return by_ == By::kTolerance ? is_least : are_most || (by_ != By::kIterations && is_least);
}

void ErrorControl::take(double iterations, int least) {
  present_.iterations =
      static_cast<int>(std::clamp(iterations, double(least), double(asked_.most_iterations)));
}

void ErrorControl::learn_tolerance(double error) {
  // Errors grow with residuals, and not always in proportion.
  if (error <= asked_.error && error >= kFarBelow * asked_.error) return;
  const double factor = error > 0.0 ? kAim * asked_.error / error : kMostStep;
  const double most = most_tolerance(), least = std::min(most, least_tolerance());
  present_.tolerance =
      std::clamp(std::clamp(factor, kLeastStep, kMostStep) * present_.tolerance, least, most);
}

void ErrorControl::learn_iterations(double error, int iterations) {
  double factor = 1.0;
  // Errors of iterations without acceleration fall slowly: as many more as the error is too large.
  if (error > asked_.error) factor = std::clamp(error / asked_.error, kLeastMore, kMostMore);
  if (error < kFarBelow * asked_.error) factor = kFewer;
  const double next =
      factor > 1.0 ? std::ceil(factor * iterations) : std::floor(factor * iterations);
  take(next, by_ == By::kTightTolerance ? std::max(1, first_.iterations) : 1);
}

void ErrorControl::learn(double error, int iterations) {
  if (!is_on()) return;
  // Of what ended before it reached its tolerance another one would change nothing.
  const bool reached = iterations < present_.iterations;
  if (by_ == By::kIterations || (by_ == By::kTightTolerance && !reached)) {
    learn_iterations(error, iterations);
  } else {
    learn_tolerance(error);
  }
}

// Both, whatever it chooses: others that read what was learned choose something else.
void ErrorControl::save(StateArchive& numbers) const {
  numbers.write(present_.iterations);
  numbers.write(present_.tolerance);
}

void ErrorControl::load(StateArchive& numbers) {
  const double iterations = numbers.read(), tolerance = numbers.read();
  if (!is_on()) return;
  if (by_ != By::kTolerance && iterations >= 1.0) take(iterations, 1);
  if (by_ != By::kIterations && tolerance > 0.0 && tolerance <= most_tolerance()) {
    present_.tolerance = tolerance;
  }
}

}  // namespace pliant
