#pragma once

#include <vector>

#include "pliant/core/group.h"
#include "pliant/core/system/body_pairs.h"
#include "pliant/effects/contact/pair_detection.h"

namespace pliant {

/// What each two bodies of a group are to each other, by their numbers there.
class BodyPairTable {
 public:
  struct Entry {
    bool touches;      ///< false: they pass through each other
    double thickness;  ///< that their surfaces keep [m]
    double friction;   ///< Coulomb coefficient
  };

  /// `options` hold where `pairs` say nothing.
  BodyPairTable(const Group& group, const BodyPairs& pairs, const PairDetection::Options& options);

  int bodies() const { return bodies_; }
  const Entry& operator()(int a, int b) const {
    return entries_[static_cast<std::size_t>(a * bodies_ + b)];
  }
  bool touches(int a, int b) const { return (*this)(a, b).touches; }
  /// That a body keeps from any other; 0 where it touches none [m].
  double most_thickness(int body) const;
  /// That any two keep [m].
  double least_thickness() const;

 private:
  int bodies_;
  std::vector<Entry> entries_;  // row by row; a body does not touch itself
};

}  // namespace pliant
