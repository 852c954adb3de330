#pragma once

#include <vector>

#include "pliant/core/particles.h"

namespace pliant {

/// An order of particles in which each `block` successive ones lie close together: recursive
/// bisection across the longest side at multiples of `block`. A function of the positions alone.
std::vector<int> order_in_blocks(const Positions& x, int block);

}  // namespace pliant
