#pragma once

#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

struct AngleRange {
  double least;
  double greatest;
};

/// The least and the greatest angle between two faces of one tetrahedron, over the whole mesh
/// [degrees], each in [0, 180]; 0 and 180 for a flat tetrahedron. The mesh must have tetrahedra.
AngleRange dihedral_angles(const TetrahedralMesh& mesh);

}  // namespace pliant
