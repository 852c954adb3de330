#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "pliant/core/body.h"

namespace pliant {

/// Cost of the steps since it was last cleared. Allocates nothing in a step without a new phase or
/// warning.
class StepStatistics {
 public:
  explicit StepStatistics(std::size_t bodies) : bodies_(bodies) {}

  /// `seconds`: wall time of the step.
  void add(const std::deque<Body>& bodies, double dt, double seconds);
  void clear();

  std::uint64_t steps() const { return steps_; }
  double mean_time() const { return steps_ > 0 ? seconds_ / static_cast<double>(steps_) : 0.0; }
  double max_time() const { return max_seconds_; }  ///< [s]
  double real_time_factor() const;
  const std::vector<PhaseTime>& phases() const { return phases_; }  ///< sums over the steps
  /// Of all bodies, each once.
  std::vector<std::string> warnings() const;

  /// Wall time of a step, as the body's reports tell it [s].
  double mean_time(std::size_t body) const;
  const std::vector<std::string>& warnings(std::size_t body) const {
    return bodies_[body].warnings;
  }

 private:
  struct OfBody {
    double seconds = 0.0;
    std::vector<std::string> warnings;
  };
  void add_phase(const PhaseTime& phase);
  static void add_warning(const std::string& warning, std::vector<std::string>& warnings);

  std::uint64_t steps_ = 0;
  double seconds_ = 0.0;
  double max_seconds_ = 0.0;
  double simulated_ = 0.0;
  std::vector<PhaseTime> phases_;
  std::vector<OfBody> bodies_;
  Timer since_;
};

}  // namespace pliant
