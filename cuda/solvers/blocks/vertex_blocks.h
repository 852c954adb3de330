#pragma once

#include <vector>

#include "pliant/core/body/particles.h"

namespace pliant {

/// From so many particles on blocks are large, whose borders are shorter, and take their simplices
/// in two passes by few threads, so that more of them are on a multiprocessor. Those of smaller
/// bodies keep their elements in its shared memory (persistent_iteration.h).
constexpr int kLargeBody = 40000;

/// Particles in a block of a body of so many, and in how many passes a block computes simplices.
struct BlockPlan {
  int block, passes;
};
BlockPlan plan_blocks(int particles);

/// An order of particles in which each `block` successive ones lie close together: recursive
/// bisection across the longest side at multiples of `block`. A function of the positions alone.
std::vector<int> order_in_blocks(const Positions& x, int block);

}  // namespace pliant
