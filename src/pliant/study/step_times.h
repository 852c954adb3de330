#pragma once

#include <vector>

#include "pliant/core/world.h"

namespace pliant {

/// Steps a world and takes the time of each step. With one thread a step's time is its processor
/// time where that is less than its wall time: what other programs took in between is no price of
/// the solver. With more threads it is the wall time.
class StepTimes {
 public:
  /// As World::step(); an untimed step leaves no trace here.
  bool step(World& world, bool is_timed = true);

  int count() const { return static_cast<int>(times_.size()); }
  double median() const;       ///< [s]; 0 of none
  double median_wall() const;  ///< of the wall times, other programs included [s]; 0 of none
  double longest() const;      ///< [s]
  double total() const;        ///< [s]
  double total_wall() const;   ///< [s]

 private:
  std::vector<double> times_;
  std::vector<double> walls_;
};

/// The lower one of the two in the middle when there is an even number; 0 of none.
double median_of(std::vector<double> values);

}  // namespace pliant
