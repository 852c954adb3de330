#pragma once

#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// The closed parts of a surface, but for those that hold less than `least` [m³] and for vertices
/// of no triangle.
void keep_large_parts(const std::vector<Eigen::Vector3d>& vertices,
                      const std::vector<Eigen::Vector3i>& triangles, double least,
                      TriangleMesh& mesh);

}  // namespace pliant
