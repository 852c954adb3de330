#include <algorithm>
#include <set>
#include <tuple>

#include "pliant/study/generated/generated_factors.h"
#include "pliant/study/generated/generated_random.h"

namespace pliant {
namespace {

/// Two values of two factors, the first factor before the second.
using ValuePair = std::tuple<int, int, int, int>;

int count_of(int factor) {
  return static_cast<int>(scene_factors()[static_cast<std::size_t>(factor)].values.size());
}

ValuePair pair_of(const SceneChoice& choice, int one, int other) {
  return {one, choice[static_cast<std::size_t>(one)], other,
          choice[static_cast<std::size_t>(other)]};
}

std::set<ValuePair> all_pairs() {
  std::set<ValuePair> pairs;
  for (int one = 0; one < kFactorCount; ++one) {
    for (int other = one + 1; other < kFactorCount; ++other) {
      for (int i = 0; i < count_of(one); ++i) {
        for (int j = 0; j < count_of(other); ++j) {
          if (go_together(static_cast<Factor>(one), i, static_cast<Factor>(other), j)) {
            pairs.insert({one, i, other, j});
          }
        }
      }
    }
  }
  return pairs;
}

SceneChoice random_choice(GeneratedRandom& random) {
  SceneChoice choice{};
  do {
    for (int f = 0; f < kFactorCount; ++f) {
      choice[static_cast<std::size_t>(f)] = random.pick(count_of(f));
    }
  } while (!is_possible(choice));
  return choice;
}

/// Of the pairs that are left, those that the value of `factor` makes.
int count_new(const SceneChoice& choice, int factor, const std::set<ValuePair>& left) {
  int count = 0;
  for (int other = 0; other < kFactorCount; ++other) {
    if (other == factor) continue;
    count += static_cast<int>(
        left.count(pair_of(choice, std::min(factor, other), std::max(factor, other))));
  }
  return count;
}

/// Holds one of the pairs that are left, and as many others as single changes can add.
SceneChoice next_choice(GeneratedRandom& random, const std::set<ValuePair>& left) {
  SceneChoice best = random_choice(random);
  auto any = left.lower_bound(pair_of(best, 0, 1));
  if (any == left.end()) any = left.begin();
  const auto& [one, i, other, j] = *any;
  do {
    best = random_choice(random);
    best[static_cast<std::size_t>(one)] = i;
    best[static_cast<std::size_t>(other)] = j;
  } while (!is_possible(best));
  for (int f = 0; f < kFactorCount; ++f) {
    if (f == one || f == other) continue;
    for (int value = 0; value < count_of(f); ++value) {
      SceneChoice changed = best;
      changed[static_cast<std::size_t>(f)] = value;
      if (is_possible(changed) && count_new(changed, f, left) > count_new(best, f, left)) {
        best = changed;
      }
    }
  }
  return best;
}

}  // namespace

std::vector<SceneChoice> plan_scenes(int count, std::uint64_t seed) {
  GeneratedRandom random(seed);
  const std::set<ValuePair> all = all_pairs();
  std::set<ValuePair> left;
  std::vector<SceneChoice> plan;
  while (static_cast<int>(plan.size()) < count) {
    if (left.empty()) left = all;
    plan.push_back(next_choice(random, left));
    for (int one = 0; one < kFactorCount; ++one) {
      for (int other = one + 1; other < kFactorCount; ++other) {
        left.erase(pair_of(plan.back(), one, other));
      }
    }
  }
  return plan;
}

}  // namespace pliant
