#pragma once

#include <optional>

#include "pliant/effects/body_contact/body_surfaces.h"

namespace pliant {

/// An edge of one body that passes through a triangle of another.
struct BodyIntersection {
  int edge_body, triangle_body;  ///< numbers in the group
  Eigen::Vector3d place;         ///< [m]
};

/// The first that there is between bodies that touch, of surfaces whose vertices are at `vertices`
/// [m].
std::optional<BodyIntersection> find_intersection(const BodySurfaces& surfaces,
                                                  const Positions& vertices,
                                                  const BodyPairTable& pairs);

}  // namespace pliant
