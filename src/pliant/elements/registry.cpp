#include "pliant/elements/registry.h"

namespace pliant {

const std::vector<ElementKind>& element_kinds() {
  static const std::vector<ElementKind> kinds = {
      {"stretch", "linear springs along warp and weft of a grid"},
      {"shear", "difference of the diagonals of a grid's cells, or linear springs along them"},
      {"bending", "quadratic bending: differences on grids, hinges or plates on triangles"},
      {"triangle_strain",
       "in-plane stretch and shear of triangles along warp and weft, with limits"},
      {"tetrahedron", "corotated (as-rigid-as-possible) tetrahedra: Poisson's ratio 0"},
      {"volume", "volume preservation of tetrahedra, exact or within limits"},
      {"strain_limit", "limits to the principal stretches of tetrahedra"},
      {"fiber", "fibres through tetrahedra along one direction of the rest shape"},
      {"cluster", "shape matching over overlapping groups of particles"},
      {"oriented_cluster",
       "shape matching of particles that turn: thin shapes resist torsion and bending"},
      {"attachment", "springs that hold particles to points of the world or of a moving frame"},
  };
  return kinds;
}

}  // namespace pliant
