#pragma once

#include <vector>

#include "cuda/solvers/step_state.h"

namespace pliant {

/// Contacts of a step for the GPU, and who is touched by them.
struct ContactTable {
  std::vector<DeviceContact> contacts;
  std::vector<DeviceContactForce> forces;  ///< first guess, then the result
  std::vector<int> touched, begins, entries, first;
  bool carried = false;  ///< points share particles

  /// Who is touched, from `contacts`, whose particles are places among `particles`.
  void index(int particles);
  /// First contact and first touched particle of each scene, and their ends, where scenes begin at
  /// the blocks `scene_begins`: 2 numbers a scene, and 2.
  std::vector<int> begins_of_scenes(const std::vector<int>& scene_begins, int block) const;
};

}  // namespace pliant
