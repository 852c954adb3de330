#pragma once

namespace pliant {

/// A move below this share of the contact's offset counts as none.
constexpr double kContactRest = 1e-4;

/// For points that share particles.
constexpr int kMaxSweeps = 12;

/// Sweeps over contacts until none moves much: points that share particles undo a little of what
/// was done for each other. `sweep` makes one and returns the largest move [m].
template <class Sweep>
void sweep_to_rest(double offset, int max_sweeps, const Sweep& sweep) {
  constexpr double kSmallShare = 1e-2;  // of the first sweep's move
  const double first = sweep();
  for (int k = 1; k < max_sweeps; ++k) {
    const double largest = sweep();
    if (largest <= kContactRest * offset || largest <= kSmallShare * first) break;
  }
}

}  // namespace pliant
