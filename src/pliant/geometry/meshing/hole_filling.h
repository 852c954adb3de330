#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// A closed run of edges with one triangle each.
struct Hole {
  std::vector<int> rim;  ///< vertices in the order that gives filling triangles outward winding
  double width;          ///< largest extent along x, y or z [m]
};

/// The holes of a mesh that validate() accepts, in ascending order of their first vertex. Where
/// two holes touch in a vertex they are parted there.
std::vector<Hole> find_holes(const TriangleMesh& mesh);

/// Adds to each hole its centre and a fan of triangles to it.
void fill_holes(TriangleMesh& mesh, const std::vector<Hole>& holes);

}  // namespace pliant
