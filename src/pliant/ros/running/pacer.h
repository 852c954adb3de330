#pragma once

#include <chrono>

namespace pliant {

/// Keeps simulated time from running ahead of the wall clock.
class Pacer {
 public:
  using Clock = std::chrono::steady_clock;

  /// `limit`: simulated over wall time that is not exceeded; infinite sets no limit.
  explicit Pacer(double limit) : limit_(limit) {}

  /// Simulated time `time` [s] is now.
  void restart(double time);
  /// When simulated time may become `time` [s]. A simulation that fell behind by more than 0.1 s is
  /// not allowed to catch up: it goes on from here at the limit.
  Clock::time_point due(double time);

 private:
  double limit_;
  Clock::time_point start_ = Clock::now();
  double start_time_ = 0.0;  // [s]
};

}  // namespace pliant
