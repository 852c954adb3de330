#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "pliant/core/state_archive.h"
#include "pliant/effects/self_contact/self_contact_pairs.h"

namespace pliant {

/// The forces with which pairs of simplices touched when the last step ended. A pair that is found
/// again begins with them.
class PairForces {
 public:
  struct Known {
    PairContact::Simplices pair;
    double normal = 0.0;                                 ///< [N]
    Eigen::Vector3d friction = Eigen::Vector3d::Zero();  ///< [N]
  };

  /// Replaces what is known by what contacts that know their simplices carry.
  void take(const std::vector<PairContact>& contacts);
  /// Null: nothing is known.
  const Known* find(const PairContact::Simplices& pair) const;
  void clear() { known_.clear(); }
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  std::vector<Known> known_;  // sorted by pair
};

}  // namespace pliant
