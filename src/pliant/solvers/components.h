#pragma once

#include <vector>

#include "pliant/core/system.h"

namespace pliant {

/// What elements hold together: the connected components of a system's free particles.
struct Components {
  static constexpr int kNone = -1;

  std::vector<int> of;       ///< component of each particle; kNone of one that is pinned
  std::vector<int> members;  ///< particles, component by component, in order
  std::vector<int> begins;   ///< of each component's members, and the end of the last one's
  std::vector<bool> pinned;  ///< whether elements tie it to a pinned particle
  /// Of each particle, the stiffness with which elements hold it from outside (attachments) [N/m].
  Eigen::VectorXd outer_stiffness;
  /// Numbers of the element sets that do so.
  std::vector<std::size_t> outer_sets;

  int count() const { return static_cast<int>(pinned.size()); }
  int size(int component) const {
    const auto c = static_cast<std::size_t>(component);
    return begins[c + 1] - begins[c];
  }
};

Components find_components(const ProjectiveSystem& system);

}  // namespace pliant
