#pragma once

#include <map>
#include <string>

#include "pliant/geometry/repair/mesh_collider.h"

namespace pliant {

/// What solids the collision meshes of a robot's links stand for.
struct LinkColliders {
  ColliderKind all = ColliderKind::kAuto;
  std::map<std::string, ColliderKind> of_link;  ///< of those that are named, instead

  ColliderKind kind_of(const std::string& link) const {
    const auto found = of_link.find(link);
    return found == of_link.end() ? all : found->second;
  }
};

}  // namespace pliant
