#pragma once

#include <cstdint>
#include <string>

#include "pliant/scene/batch.h"

namespace pliant {

/// What a batch writes, and how it shows that it runs.
struct BatchOutput {
  std::string folder;       ///< empty: nothing
  std::uint64_t every = 0;  ///< a row of every scene each so many steps; 0: the last alone
  bool overwrite = false;
  bool progress = false;
  bool quiet = false;
};

/// Steps all scenes of `batch`, made from `table`, and writes
///   scenes.csv               a row a scene and recorded step: what was varied, energies, the state
///   positions_BODY.npy       scene, particle, axis: where each body's particles ended [m]
/// Returns the exit code: kNotFinite when a scene stopped. Throws InputError.
int run_batch(Batch& batch, const SceneValueTable& table, std::uint64_t steps,
              const BatchOutput& output);

}  // namespace pliant
