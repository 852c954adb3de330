#pragma once

#include <vector>

#include "cuda/solvers/step_state.h"

namespace pliant {

/// Contacts of a step for the GPU, and who is touched by them.
struct ContactTable {
  std::vector<DeviceContact> contacts;
  std::vector<DeviceContactForce> forces;  ///< first guess, then the result
  std::vector<int> touched, begins, entries, first;
  bool embedded = false;  ///< points share particles
  /// First contact and first touched particle of each scene, and their ends: 2 numbers a scene, 2.
  std::vector<int> begins_of_scenes;

  /// Who is touched, from `contacts`, whose particles are places among `particles`: of one scene.
  void index(int particles);
};

/// Tables of scenes whose places begin at `first_places` (with the end), as one.
void join(const std::vector<const ContactTable*>& tables, const std::vector<int>& first_places,
          ContactTable& joined);

}  // namespace pliant
