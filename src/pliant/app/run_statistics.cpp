#include "pliant/app/run_statistics.h"

#include <algorithm>

namespace pliant {

void RunStatistics::add(const World& world, double wall_seconds, std::uint64_t steps) {
  constexpr std::size_t kMaxWarnings = 100;
  steps_ += steps;
  seconds_ += wall_seconds;
  longest_ = std::max(longest_, wall_seconds / static_cast<double>(steps));
  for (const Body& body : world.bodies()) {
    for (const PhaseTime& phase : body.report.phases) {
      const auto same = [&](const auto& known) { return known.first == phase.name; };
      auto found = std::find_if(phases_.begin(), phases_.end(), same);
      if (found == phases_.end()) found = phases_.insert(found, {std::string(phase.name), 0.0});
      found->second += phase.seconds;
    }
    if (!body.report.first_order.empty()) {
      ++first_order_[body.name + ": " + std::string(body.report.first_order)];
    }
    for (const std::string& warning : body.report.warnings) {
      const std::string text = body.name + ": " + warning;
      if (warnings_.size() < kMaxWarnings || warnings_.count(text) != 0) ++warnings_[text];
    }
  }
}

std::vector<std::pair<std::string, double>> RunStatistics::phases() const {
  std::vector<std::pair<std::string, double>> all = phases_;
  double rest = seconds_;
  for (const auto& phase : phases_) rest -= phase.second;
  all.emplace_back("other", std::max(0.0, rest));
  return all;
}

}  // namespace pliant
