#pragma once

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// Points spread over a triangle mesh, 3 x n [m]: its vertices and points within large triangles,
/// no two nearer than half of `spacing` [m] to each other, and every point of the surface within
/// `spacing` of one. Throws InputError where `spacing` is not positive and finite or asks for more
/// than kMaxTriangles points.
Eigen::Matrix3Xd sample_surface(const TriangleMesh& mesh, double spacing);

/// Mean length of a mesh's edges, each triangle's counted for itself [m].
double mean_edge_length(const TriangleMesh& mesh);

}  // namespace pliant
