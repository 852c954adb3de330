#include "pliant/ros/running/step_statistics.h"

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
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const StepReport& report = bodies[b].report;
    bodies_[b].seconds += report.seconds;
    for (const PhaseTime& phase : report.phases) add_phase(phase);
    for (const std::string& warning : report.warnings) add_warning(warning, bodies_[b].warnings);
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

void StepStatistics::add_warning(const std::string& warning, std::vector<std::string>& warnings) {
  if (warnings.size() >= kMaxWarnings) return;
  if (std::find(warnings.begin(), warnings.end(), warning) != warnings.end()) return;
  warnings.push_back(warning);
}

std::vector<std::string> StepStatistics::warnings() const {
  std::vector<std::string> all;
  for (const OfBody& body : bodies_) {
    for (const std::string& warning : body.warnings) add_warning(warning, all);
  }
  return all;
}

double StepStatistics::mean_time(std::size_t body) const {
  return steps_ > 0 ? bodies_[body].seconds / static_cast<double>(steps_) : 0.0;
}

double StepStatistics::real_time_factor() const {
  const double wall = since_.seconds();
  return wall > 0.0 ? simulated_ / wall : 0.0;
}

void StepStatistics::clear() {
  steps_ = 0;
  seconds_ = max_seconds_ = simulated_ = 0.0;
  phases_.clear();
  for (OfBody& body : bodies_) {
    body.seconds = 0.0;
    body.warnings.clear();
  }
  since_ = Timer();
}

}  // namespace pliant
