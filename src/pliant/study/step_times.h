#pragma once

#include <vector>

#include "pliant/core/world.h"

namespace pliant {

/// Steps a world and takes the time of each step.
class StepTimes {
 public:
  /// As World::step(); an untimed step leaves no trace here.
  bool step(World& world, bool is_timed = true);

  int count() const { return static_cast<int>(wall_.size()); }
  double median_wall() const;       ///< [s]; 0 of none
  double median_processor() const;  ///< processor time of all threads [s]; 0 of none
  double longest_wall() const;      ///< [s]
  double total_wall() const;        ///< [s]

 private:
  std::vector<double> wall_;
  std::vector<double> processor_;
};

/// The lower one of the two in the middle when there is an even number; 0 of none.
double median(std::vector<double> values);

}  // namespace pliant
