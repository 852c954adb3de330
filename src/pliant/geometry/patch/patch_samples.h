#pragma once

#include "pliant/geometry/patch/patch_surface.h"

namespace pliant {

/// Points spread over the surface of patches, for contact.
struct PatchSamples {
  Eigen::Matrix3Xd points;       ///< 3 x n, on the surface [m]
  Eigen::Matrix3Xd normals;      ///< 3 x n, outward unit
  Eigen::VectorXi patch;         ///< n: a patch that the point belongs to
  Eigen::Matrix3Xd barycentric;  ///< 3 x n: its coordinates on that patch's base triangle
};

/// The base's vertices, then points on its edges and within its patches, no two of those nearer
/// than half of `spacing` [m] to each other. Where the surface is not much steeper than its base,
/// every point of it has a sample within `spacing`. Large patches so get more points than small
/// ones, where polygonise() gives all the same. Throws InputError where `spacing` is not positive
/// and finite or asks for more than kMaxTriangles points.
PatchSamples sample_points(const PatchSurface& surface, double spacing);

}  // namespace pliant
