#include "pliant/solvers/checks/error_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "pliant/math/rounded_percent.h"
#include "pliant/solvers/time/midpoint_rule.h"

namespace pliant {
namespace {

// What estimates may cost of the work of all steps.
constexpr double kWorkShare = 0.05;
// Work at the start that need not be saved up for, and work ahead of what was saved when something
// touches.
constexpr double kFirst = 600.0, kAhead = 2400.0;
// Iterations that cost more earn an estimate in fewer steps, so that both may be as many times
// more; from this price on, no more than that.
constexpr double kDearest = 4.0;
// Time constant with which an earlier, larger error stops to count [s]: the error of what swings
// passes zero twice in each period, and is as large again afterwards.
constexpr double kFading = 0.5;
// Steps from one estimate to the next where their work is no matter.
constexpr double kClosely = 64.0;
// Steps in a row that are estimated when something touches.
constexpr int kBurst = 16;
// Errors that a single step does not prove: so large, and so many times the former one. It takes so
// many in a row.
constexpr double kDoubtful = 0.01, kDoubtfulRise = 1.5;
constexpr int kDoubts = 8;

/// Steps of `dt`, which are those of implicit Euler that a solver knows, in one of the scene's: its
/// substeps, and more where an integration of second order makes a whole step of a shorter one. All
/// of them miss as much: v = (x - x*) / h*, so that what is missed of x goes on with 1 / h*.
double effective_steps(double dt, const StepReport& report) {
  return report.dt > dt ? report.dt / dt : 1.0;
}

}  // namespace

bool ErrorWatch::begins_to_touch(const System& system) {
  active_.resize(system.constraints.size(), 0);
  bool begins = false;
  for (std::size_t c = 0; c < active_.size(); ++c) {
    const int active = system.constraints[c]->active();
    begins = begins || active > 2 * active_[c];
    active_[c] = active;
  }
  return begins;
}

bool ErrorWatch::is_due(const System& system, const StepReport& report) {
  touches_ = begins_to_touch(system);
  if (touches_) burst_ = kBurst;
  credit_ += kWorkShare * price_ * std::max(1, report.iterations);
  if (is_first(report)) return true;
  // Another substep of the same step.
  if (report.step == error_step_) return false;
  if (burst_ > 0 && credit_ > -kAhead * std::min(kDearest, price_)) {
    --burst_;
    return true;
  }
  const auto age = static_cast<double>(report.step - error_step_);
  return credit_ >= 0.0 || (is_watched_ && age >= least_);
}

ErrorWatch::Told ErrorWatch::told(double error) const {
  const int piece = estimate_.worst_piece();
  return {error, estimate_.distance(piece), piece};
}

void ErrorWatch::update(Told& told) const {
  const double distance = estimate_.distance(told.piece);
  // Where a body comes back to where it began, no share grows of what it was off elsewhere.
  if (!(distance > told.distance) || !estimate_.is_free(told.piece)) return;
  told.error *= told.distance / distance;
  told.distance = distance;
}

bool ErrorWatch::estimate(ProjectiveSystem& system, double dt, const StepReport& report) {
  const bool first = is_first(report);
  if (first) {
    estimate_.begin();
    worst_ = Told();
  }
  StepErrorEstimate::Elapsed elapsed;
  elapsed.last = effective_steps(dt, report);
  if (!first) elapsed.before = elapsed.last * double(report.step - error_step_ - 1);
  if (first || touches_) unseen_ = doubts_ = 0;
  elapsed.missing = touches_ ? 0.0 : elapsed.before + unseen_;
  double error = estimate_.estimate(system, dt, elapsed);
  unseen_ = 0.0;
  if (elapsed.missing > 0.0 && doubts(error)) {
    // What began shortly before is taken to have lasted as long by now as it goes on: one step
    // before for each one after.
    const double counted = doubts_ > 0 ? std::min(elapsed.last, elapsed.missing) : 0.0;
    unseen_ = elapsed.missing - counted;
    elapsed.missing = counted;
    if (unseen_ > 0.0) error = estimate_.recount(system, dt, elapsed);
  }
  // The next one counts all steps since the last that succeeded.
  if (error < 0.0) unseen_ = 0.0;
  doubts_ = unseen_ > 0.0 ? doubts_ + 1 : 0;
  if (error < 0.0) return false;
  if (unseen_ > 0.0) burst_ = std::max(burst_, 1);
  error_ = told(error);
  if (is_watched_) lasting_ = estimate_.lasting(system, dt, report.time);
  error_step_ = report.step;
  credit_ = (first ? kFirst * std::min(kDearest, price_) : credit_) - estimate_.work();
  least_ = first ? 1.0 : std::min(2.0 * least_, kClosely);
  return true;
}

bool ErrorWatch::doubts(double error) const {
  return doubts_ < kDoubts && error > kDoubtful && error > kDoubtfulRise * error_.error;
}

bool ErrorWatch::observe(ProjectiveSystem& system, double dt, std::string_view cure,
                         StepReport& report) {
  // Of its steps those of implicit Euler begin elsewhere.
  const bool is_midpoint = report.time_integration == MidpointRule().name();
  estimate_.set_doubled(is_midpoint && !system.particles.inertia.is_used);
  const bool estimates = is_due(system, report);
  // Of no finite state nothing is told: the step will be undone.
  if (estimates && !estimate(system, dt, report)) return false;
  // Steps of clusters are so cheap that the next estimate may be far away, and miss little but
  // where something touches. Those of others miss as much as before: the share stays.
  if (estimate_.has_clusters(error_.piece)) update(error_);
  Told now = error_;
  if (report.step > error_step_) {
    // No smaller a share than it was: steps since then missed something too.
    const double steps = effective_steps(dt, report) * double(report.step - error_step_);
    const Told later = told(estimate_.later(system, dt, steps));
    if (later.error > now.error) now = later;
  }
  // Once a step, however many substeps it has.
  const auto since = static_cast<double>(report.step - std::min(report.step, worst_step_));
  worst_.error *= std::exp(-since * report.dt / kFading);
  update(worst_);
  if (now.error > worst_.error) worst_ = now;
  worst_step_ = report.step;
  report.error = std::max(worst_.error, report.error.value_or(0.0));
  report.error_step = error_step_;
  if (worst_.error > kInaccurate) {
    report.warn(fmt::format("inaccurate: about {} % off; {}", rounded_percent(worst_.error), cure));
  }
  return estimates;
}

void ErrorWatch::forget() {
  error_step_ = 0;
  worst_ = Told();
  active_.clear();
  burst_ = 0;
  unseen_ = doubts_ = 0;
}

void ErrorWatch::save(StateArchive& numbers) const {
  for (const Told& told : {error_, worst_}) {
    for (const double value : {told.error, told.distance, double(told.piece)}) numbers.write(value);
  }
  for (const double value :
       {static_cast<double>(error_step_), static_cast<double>(worst_step_), least_, credit_,
        double(burst_), unseen_, double(doubts_), static_cast<double>(active_.size())}) {
    numbers.write(value);
  }
  for (const int active : active_) numbers.write(active);
  estimate_.save(numbers);
}

void ErrorWatch::load(StateArchive& numbers) {
  if (numbers.left() == 0) return;  // of a solver that saved less
  for (Told* told : {&error_, &worst_}) {
    told->error = numbers.read();
    told->distance = numbers.read();
    told->piece = numbers.read_int();
  }
  constexpr std::int64_t kMostSteps = std::int64_t{1} << 53;
  constexpr int kMostOfSome = 1 << 30;  // twice as many is an int, too
  error_step_ = static_cast<std::uint64_t>(numbers.read_whole(0, kMostSteps));
  worst_step_ = static_cast<std::uint64_t>(numbers.read_whole(0, kMostSteps));
  least_ = numbers.read();
  credit_ = numbers.read();
  burst_ = numbers.read_index(kMostOfSome);
  unseen_ = numbers.read();
  doubts_ = numbers.read_index(kMostOfSome);
  active_.resize(numbers.read_count());
  for (int& active : active_) active = numbers.read_index(kMostOfSome);
  estimate_.load(numbers);
}

}  // namespace pliant
