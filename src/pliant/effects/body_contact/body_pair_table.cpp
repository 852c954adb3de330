#include "pliant/effects/body_contact/body_pair_table.h"

#include <algorithm>
#include <limits>

namespace pliant {

BodyPairTable::BodyPairTable(const Group& group, const BodyPairs& pairs,
                             const PairDetection::Options& options)
    : bodies_(static_cast<int>(group.bodies().size())) {
  for (const Body* a : group.bodies()) {
    for (const Body* b : group.bodies()) {
      const BodyPairs::Numbers own = pairs.numbers(*a, *b);
      entries_.push_back({a != b && pairs.may_touch(*a, *b),
                          own.thickness.value_or(options.thickness),
                          own.friction.value_or(options.friction)});
    }
  }
}

double BodyPairTable::most_thickness(int body) const {
  double most = 0.0;
  for (int other = 0; other < bodies_; ++other) {
    const Entry& entry = (*this)(body, other);
    if (entry.touches) most = std::max(most, entry.thickness);
  }
  return most;
}

double BodyPairTable::least_thickness() const {
  double least = std::numeric_limits<double>::infinity();
  for (const Entry& entry : entries_) {
    if (entry.touches) least = std::min(least, entry.thickness);
  }
  return least;
}

}  // namespace pliant
