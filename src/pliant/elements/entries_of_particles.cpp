#include "pliant/elements/entries_of_particles.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace pliant {
namespace {

std::vector<int> numbers(std::size_t count) {
  std::vector<int> result(count);
  std::iota(result.begin(), result.end(), 0);
  return result;
}

/// Stable, so that equal ones stay in order.
template <class Key>
void sort_by(const Key& key, std::vector<int>& list) {
  std::stable_sort(list.begin(), list.end(), [&](int a, int b) { return key(a) < key(b); });
}

}  // namespace

EntriesOfParticles::EntriesOfParticles(const std::vector<int>& vertices, int corners)
    : entries(numbers(vertices.size())),
      order(numbers(vertices.size() / static_cast<std::size_t>(corners))) {
  const auto particle = [&](int entry) { return vertices[static_cast<std::size_t>(entry)]; };
  sort_by(particle, entries);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    if (!particles.empty() && particles.back() == particle(entries[k])) continue;
    particles.push_back(particle(entries[k]));
    begins.push_back(static_cast<int>(k));
  }
  begins.push_back(static_cast<int>(entries.size()));
  const auto sum_of_particles = [&](int element) {
    long long sum = 0;
    for (int k = 0; k < corners; ++k) sum += particle(corners * element + k);
    return sum;
  };
  sort_by(sum_of_particles, order);
}

}  // namespace pliant
