#include "pliant/effects/contact/pair_forces.h"

#include <algorithm>
#include <limits>

namespace pliant {
namespace {

bool comes_before(const PairForces::Known& a, const PairForces::Known& b) {
  return a.pair < b.pair;
}

}  // namespace

void PairForces::take(const std::vector<PairContact>& contacts) {
  known_.clear();
  for (const PairContact& contact : contacts) {
    const bool is_pressed = contact.normal_force != 0.0 || !contact.friction_force.isZero(0.0);
    if (!is_pressed || contact.simplices == PairContact::kUnknown) continue;
    known_.push_back({contact.simplices, contact.normal_force, contact.friction_force});
  }
  // Of those found twice in a step both act.
  std::stable_sort(known_.begin(), known_.end(), comes_before);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < known_.size(); ++k) {
    if (kept > 0 && known_[kept - 1].pair == known_[k].pair) {
      known_[kept - 1].normal += known_[k].normal;
      known_[kept - 1].friction += known_[k].friction;
    } else {
      known_[kept++] = known_[k];
    }
  }
  known_.resize(kept);
}

const PairForces::Known* PairForces::find(const PairContact::Simplices& pair) const {
  Known wanted;
  wanted.pair = pair;
  const auto found = std::lower_bound(known_.begin(), known_.end(), wanted, comes_before);
  return found == known_.end() || found->pair != pair ? nullptr : &*found;
}

void PairForces::save(StateArchive& numbers) const {
  numbers.write(static_cast<double>(known_.size()));
  for (const Known& known : known_) {
    for (const int number : known.pair) numbers.write(number);
    numbers.write(known.normal);
    numbers.write_all(known.friction);
  }
}

void PairForces::load(StateArchive& numbers) {
  constexpr std::size_t kNumbersOfEach = std::tuple_size_v<PairContact::Simplices> + 4;
  known_.resize(numbers.read_count(kNumbersOfEach));
  for (Known& known : known_) {
    for (int& number : known.pair) number = numbers.read_index(std::numeric_limits<int>::max());
    known.normal = numbers.read();
    numbers.read_all(known.friction);
  }
}

}  // namespace pliant
