#pragma once

#include <optional>

#include "pliant/effects/body_contact/body_surfaces.h"

namespace pliant {

/// A body of which something is within a solid one, though no edge passes through a triangle.
struct BodyContainment {
  int inner_body, outer_body;  ///< numbers in the group
  int count;                   ///< of the inner body's vertices or balls that are within
  bool are_all;                ///< that it has
  Eigen::Vector3d place;       ///< of the first of them [m]
};

/// The first that there is between bodies that touch, of surfaces whose vertices are at `vertices`
/// [m]. What is on a solid's surface is not within it.
std::optional<BodyContainment> find_containment(const BodySurfaces& surfaces,
                                                const Positions& vertices,
                                                const BodyPairTable& pairs);

}  // namespace pliant
