#pragma once

#include <Eigen/Core>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// The convex hull of points (3 x n, [m]), its triangles turning outward, by qhull (Barber et al.
/// 1996). Throws InputError where they lie in one plane to round-off, so that it has no inside.
TriangleMesh convex_hull(const Eigen::Matrix3Xd& points);

}  // namespace pliant
