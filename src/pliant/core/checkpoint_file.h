#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/checkpoint.h"

namespace pliant {

/// A checkpoint with what its owner keeps beside the world, as a file holds it.
struct SavedState {
  Checkpoint checkpoint;
  std::vector<std::vector<double>> joints;  ///< of each robot that a program moves [m] or [rad]
};

/// As bytes, which this version of Pliant on such a machine reads. Throws InputError for what
/// no file holds: forces that act, and fields on their way to a value.
std::string state_bytes(const SavedState& state);
/// Back from state_bytes(). Throws InputError "WHERE: ..." for bytes that are damaged, no state, or
/// of another version.
SavedState state_of(std::string_view bytes, const std::string& where);

}  // namespace pliant
