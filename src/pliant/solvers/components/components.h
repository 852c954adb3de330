#pragma once

#include <vector>

#include "pliant/core/system/system.h"

namespace pliant {

/// What elements hold together: the connected components of a system's free particles.
struct Components {
  static constexpr int kNone = -1;

  std::vector<int> of;       ///< component of each particle; kNone of one that is pinned
  std::vector<int> members;  ///< particles, component by component, in order
  std::vector<int> begins;   ///< of each component's members, and the end of the last one's
  /// Whether elements tie it to a pinned particle or to a place, or others move it: its rigid
  /// motions are not free.
  std::vector<bool> held;
  /// Whether elements have a torque on it, so that they keep no angular momentum of its particles.
  std::vector<bool> twisted;

  int count() const { return static_cast<int>(held.size()); }
};

Components find_components(const ProjectiveSystem& system);

}  // namespace pliant
