#pragma once

#include "pliant/geometry/patch/patch_surface.h"

namespace pliant {

constexpr int kMaxPatchLevel = 256;

/// A triangle mesh on the surface of patches, and where its vertices lie.
struct PatchPolygons {
  TriangleMesh mesh;             ///< n vertices on the surface [m]; closed where the base is
  Eigen::VectorXi patch;         ///< n: a patch that the vertex belongs to
  Eigen::Matrix3Xd barycentric;  ///< 3 x n: its coordinates on that patch's base triangle
};

/// Cuts every patch into level² triangles over a barycentric grid of its base triangle. Vertices on
/// edges and corners are shared, so that the mesh stays closed however it is deformed. Vertices of
/// the base come first, in its order, then those of the edges, then those within the patches.
/// `level` in [1, kMaxPatchLevel]; throws InputError outside, and where the mesh would have more
/// than kMaxTriangles triangles.
PatchPolygons polygonise(const PatchSurface& surface, int level);

}  // namespace pliant
