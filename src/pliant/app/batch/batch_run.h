#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "pliant/app/batch/batch_folder.h"
#include "pliant/app/batch/batch_trajectory.h"
#include "pliant/scene/batch.h"

namespace pliant {

/// Which scenes a batch has, and how long they run.
struct BatchInput {
  std::string scene;  ///< file
  SceneOverrides overrides;
  std::size_t begin = 0, end = 0;  ///< of the table's rows
  /// How many steps of such a length [s].
  std::function<std::uint64_t(double)> steps;
  std::string settings;  ///< what else makes another result
};

/// What a batch writes, and how it shows that it runs.
struct BatchOutput {
  std::string folder;  ///< empty: nothing
  BatchFolder::Start start = BatchFolder::Start::kNew;
  std::uint64_t every = 0;  ///< a row of every scene each so many steps; 0: the last alone
  TrajectoryOptions trajectory;
  double checkpoint =
      0.0;              ///< scenes that are not finished are kept each so many seconds; 0: never
  double memory = 1e9;  ///< that scenes may take at once, about [bytes]
  bool progress = false;
  bool quiet = false;
};

/// Steps the scenes of some rows of `table`, group after group, as many at once as fit the memory,
/// and writes, whenever a group is finished,
///   scenes.csv               a row a scene and recorded step: what was varied, energies, the state
///   positions_BODY.npy       scene, particle, axis: where each body's particles ended [m]
///   trajectory_*             (batch_trajectory.h)
///   warnings.csv             what its steps warned of (batch_warnings.h)
/// What is written depends neither on the groups nor on threads. Returns the exit code: kNotFinite
/// when a scene stopped or was refused. Throws InputError, also where none of the first 1000 rows
/// is accepted.
int run_batch(const BatchInput& input, SceneTable& table, const BatchOutput& output);

}  // namespace pliant
