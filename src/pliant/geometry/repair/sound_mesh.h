#pragma once

#include <string>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// A mesh that is as clean as it gets without new triangles, and what is known of it.
struct SoundMesh {
  TriangleMesh mesh;         ///< clean_mesh(), turn_outward(); the given one if it has no faults
  bool is_manifold = false;  ///< each edge has one triangle, or two that agree
  bool closed = false;       ///< each edge has two triangles that agree
  bool overlaps = false;     ///< closed, and parts of it pass through each other
  std::vector<std::string> faults;  ///< all of the given mesh, a phrase each; empty for a clean one
};

/// Throws InputError, with all faults, for a mesh without vertices or without a triangle that has
/// an area, with more than kMaxTriangles, with vertices that are not finite, or with indices out of
/// range.
SoundMesh make_sound(const TriangleMesh& mesh);

}  // namespace pliant
