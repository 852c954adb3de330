#pragma once

#include <memory>
#include <vector>

#include "pliant/core/system/element_set.h"
#include "pliant/elements/yarn.h"

namespace pliant {

/// Yarns, colour by colour: those of one share no particle.
struct Yarns {
  std::vector<Yarn> all;
  std::vector<int> begins;  ///< first yarn of each colour, and the end
};

/// Of all `elements` that have some (HasYarns); maybe none.
Yarns find_yarns(const std::vector<std::unique_ptr<ElementSet>>& elements, int particles);

/// Paths between neighbours along warp and weft: what lies across them may shear to no more.
std::vector<ClothEdge> find_edges(const std::vector<std::unique_ptr<ElementSet>>& elements);

}  // namespace pliant
