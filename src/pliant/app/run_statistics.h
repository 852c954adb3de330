#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/world.h"

namespace pliant {

/// Sums over the steps of a run.
class RunStatistics {
 public:
  /// Adds the world's last steps, which took `wall_seconds` together; of several nobody saw but the
  /// last (World::advance()).
  void add(const World& world, double wall_seconds, std::uint64_t steps = 1);

  std::uint64_t steps() const { return steps_; }
  double seconds() const { return seconds_; }  ///< wall time of all steps [s]
  double longest() const { return longest_; }  ///< of one step [s]
  /// Phases and effects in the order they ran, with their wall time in all steps [s]; what is left
  /// comes last as "other".
  std::vector<std::pair<std::string, double>> phases() const;
  /// Each warning with the number of steps that gave it.
  const std::map<std::string, std::uint64_t>& warnings() const { return warnings_; }
  /// "BODY: REASON" with the number of steps of first order that had it, of bodies whose time
  /// integration is of second.
  const std::map<std::string, std::uint64_t>& first_order() const { return first_order_; }

 private:
  std::uint64_t steps_ = 0;
  double seconds_ = 0.0;
  double longest_ = 0.0;
  std::vector<std::pair<std::string, double>> phases_;
  std::map<std::string, std::uint64_t> warnings_, first_order_;
};

}  // namespace pliant
