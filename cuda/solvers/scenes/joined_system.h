#pragma once

#include <vector>

#include "cuda/solvers/scenes/packed_system.h"

namespace pliant {

/// Packed systems one after the other, as scenes of one: each begins with a block of its own, and
/// the places that its last block has left hold nothing. All have blocks of one size.
PackedSystem join(const std::vector<const PackedSystem*>& systems);

}  // namespace pliant
