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
  /// `seconds`: wall time of the step.
  void add(const std::deque<Body>& bodies, double dt, double seconds);
  void clear();

  std::uint64_t steps() const { return steps_; }
  double mean_time() const { return steps_ > 0 ? seconds_ / static_cast<double>(steps_) : 0.0; }
  double max_time() const { return max_seconds_; }  ///< [s]
  double real_time_factor() const;
  const std::vector<PhaseTime>& phases() const { return phases_; }  ///< sums over the steps
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void add_phase(const PhaseTime& phase);
  void add_warning(const std::string& warning);

  std::uint64_t steps_ = 0;
  double seconds_ = 0.0;
  double max_seconds_ = 0.0;
  double simulated_ = 0.0;
  std::vector<PhaseTime> phases_;
  std::vector<std::string> warnings_;
  Timer since_;
};

}  // namespace pliant
