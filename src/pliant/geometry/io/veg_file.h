#pragma once

#include <optional>
#include <string>

#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// What a file says that its tetrahedra are made of.
struct FileMaterial {
  std::string name;
  double density;  ///< [kg/m³], > 0
  double young;    ///< Young's modulus [Pa], > 0
  double poisson;  ///< Poisson's ratio, in (-1, 0.5)
};

/// Tetrahedra and their material, where the file has one.
struct MeshWithMaterial {
  TetrahedralMesh mesh;
  std::optional<FileMaterial> material;
};

/// Reads a volumetric mesh of the Vega FEM library (.veg, text) from its bytes; `path` says where
/// the files of its *INCLUDE lines stand, and is named in errors. Its layout as that library's
/// libraries/volumetricMesh/volumetricMesh.cpp reads it: sections *VERTICES, *ELEMENTS (TET),
/// *MATERIAL (ENU: density, Young's modulus, Poisson's ratio), *SET and *REGION (a set and its
/// material; of several that name an element the last one counts); vertices and elements are
/// counted from 0 where the first is 0, else from 1. Where there are no regions there is no
/// material.
///
/// Throws InputError, naming file and line: stricter than that library, which skips what it does
/// not know. Refused are also numbers out of order, counts that the sections do not hold, elements
/// without a material beside others with one, and what no body of ours is made of: cubes, other
/// materials than ENU, tetrahedra of more than one material. See also read_tetrahedral_mesh().
MeshWithMaterial read_veg(const std::string& path, const std::string& bytes);

}  // namespace pliant
