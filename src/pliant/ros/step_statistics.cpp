#include "pliant/ros/step_statistics.h"

#include <algorithm>

namespace pliant {
namespace {

// A warning with a changing number in it must not fill a message.
constexpr std::size_t kMaxWarnings = 20;

}  // namespace

void StepStatistics::add(const std::deque<Body>& bodies, double dt, double seconds) {
  ++steps_;
  seconds_ += seconds;
  max_seconds_ = std::max(max_seconds_, seconds);
  simulated_ += dt;
  for (const Body& body : bodies) {
    for (const PhaseTime& phase : body.report.phases) add_phase(phase);
    for (const std::string& warning : body.report.warnings) add_warning(warning);
  }
}

void StepStatistics::add_phase(const PhaseTime& phase) {
  for (PhaseTime& known : phases_) {
    if (known.name == phase.name) {
      known.seconds += phase.seconds;
      return;
    }
  }
  phases_.push_back(phase);
}

void StepStatistics::add_warning(const std::string& warning) {
  if (warnings_.size() >= kMaxWarnings) return;
  if (std::find(warnings_.begin(), warnings_.end(), warning) != warnings_.end()) return;
  warnings_.push_back(warning);
}

double StepStatistics::real_time_factor() const {
  const double wall = since_.seconds();
  return wall > 0.0 ? simulated_ / wall : 0.0;
}

void StepStatistics::clear() {
  steps_ = 0;
  seconds_ = max_seconds_ = simulated_ = 0.0;
  phases_.clear();
  warnings_.clear();
  since_ = Timer();
}

}  // namespace pliant
