#include "pliant/solvers/error_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pliant {
namespace {

// What estimates may cost of the work of all steps.
constexpr double kWorkShare = 0.05;
// Work at the start that need not be saved up for, and work ahead of what was saved when something
// touches.
constexpr double kFirst = 200.0, kAhead = 800.0;
// Steps for which an estimate stands at the most.
constexpr double kMostSteps = 32.0;
// Steps from one estimate to the next where their work is no matter.
constexpr double kClosely = 16.0;
// Steps in a row that are estimated when something touches.
constexpr int kBurst = 16;

/// In steps of two to two and a half, so that a run has few different warnings.
int rounded_percent(double error) {
  constexpr int kSteps[] = {5, 10, 20, 50, 100};
  for (const int percent : kSteps) {
    if (error < 0.015 * percent) return percent;
  }
  return 200;
}

}  // namespace

bool ErrorWatch::is_due(const System& system, const StepReport& report) {
  int active = 0;
  for (const Coupling* coupling : system.couplings) active += coupling->active();
  if (active > 2 * active_) burst_ = kBurst;
  active_ = active;
  credit_ += kWorkShare * price_ * std::max(1, report.iterations);
  if (is_first(report)) return true;
  // Another part of the same step.
  if (report.step == error_step_) return false;
  if (burst_ > 0 && credit_ > -kAhead * price_) {
    --burst_;
    return true;
  }
  const auto age = static_cast<double>(report.step - error_step_);
  return age >= least_ && (credit_ >= 0.0 || is_watched_);
}

void ErrorWatch::take(double error, double dt, const StepReport& report) {
  const bool first = is_first(report);
  const auto age = static_cast<double>(report.step - error_step_);
  const double steps = first ? 1.0 : std::min(age, kMostSteps);
  seen_ = first ? 1.0 : std::min(seen_ + steps, StepErrorEstimate::kHorizon / dt);
  // Each stands for the steps since the one before it, but not for too many.
  error_ = first ? error : error_ + std::min(1.0, steps / seen_) * (error - error_);
  error_step_ = report.step;
  // Soon after the start, to see what the scene is like.
  credit_ = (first ? kFirst * price_ : credit_) - estimate_.work();
  least_ = first ? 1.0 : std::min(2.0 * least_, kClosely);
}

bool ErrorWatch::observe(ProjectiveSystem& system, double dt, std::string_view cure,
                         StepReport& report) {
  const bool estimates = is_due(system, report);
  if (estimates) {
    latest_ = estimate_.estimate(system, dt, report.time);
    if (latest_ < 0.0) return false;  // of no finite state: the step will be undone
    take(latest_, dt, report);
  }
  report.error = std::max(error_, report.error.value_or(0.0));
  report.error_step = error_step_;
  if (error_ > kInaccurate) {
    report.warn(fmt::format("inaccurate: about {} % off; {}", rounded_percent(error_), cure));
  }
  return estimates;
}

void ErrorWatch::save(SavedNumbers& numbers) const {
  for (const double value : {error_, seen_, static_cast<double>(error_step_), least_, credit_,
                             double(active_), double(burst_)}) {
    numbers.write(value);
  }
}

void ErrorWatch::load(SavedNumbers& numbers) {
  double values[7];
  for (double& value : values) value = numbers.read();
  // Those of a solver that saved less are no numbers.
  if (!std::all_of(std::begin(values), std::end(values), [](double v) { return std::isfinite(v); }))
    return;
  error_ = values[0];
  seen_ = values[1];
  error_step_ = static_cast<std::uint64_t>(values[2]);
  least_ = values[3];
  credit_ = values[4];
  active_ = static_cast<int>(values[5]);
  burst_ = static_cast<int>(values[6]);
}

}  // namespace pliant
