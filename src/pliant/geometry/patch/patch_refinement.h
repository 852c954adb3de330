#pragma once

#include "pliant/geometry/patch/patch_surface.h"
#include "pliant/geometry/search/nearest_triangle.h"

namespace pliant {

/// Moves the quadrics of a body so that its surface comes nearer to the mesh: Gauss-Newton's steps
/// on the distances of a grid of its points, all quadrics at once, damped as Levenberg and
/// Marquardt do, with weights that grow with a distance's fourth power, so that the greatest ones
/// count most. The surface keeps its vertices. A quadric that is zero, an edge's that is better
/// flat, stays so. The result is never farther off, by that measure, than `body`.
PatchBody refine_quadrics(const PatchBody& body, const NearestTriangle& to_mesh);

}  // namespace pliant
