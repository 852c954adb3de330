#pragma once

#include <string>

#include "pliant/geometry/io/veg_file.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// Reads the tetrahedra of
/// - a Gmsh file (.msh), format 2.2 or 4.1, text or little-endian binary: elements of type 4;
/// points,
///   lines and faces are skipped, physical groups ignored;
/// - a pair of TetGen files: give the .ele or the .node file, the other stands beside it.
/// Attributes,
///   markers and the midpoints of second-order tetrahedra are skipped;
/// - a volumetric mesh of the Vega FEM library (.veg, see read_veg()), whose material comes with
/// it. Coordinates are in metres. Vertices in no tetrahedron are left out; tetrahedra with the
/// other winding (TetGen's habit) are wound the right way.
///
/// Throws InputError, naming the file and the line (the byte, where binary), when a file is
/// missing, has another extension, format or version, is truncated or garbage, numbers a vertex
/// twice or a tetrahedron by a vertex that is not there, or holds volume elements other than
/// tetrahedra (.msh: linear ones), which are named; and as validate() does, naming tetrahedra by
/// their place in the file, counted from 0.
MeshWithMaterial read_tetrahedral_file(const std::string& path);

/// The same without the material.
inline TetrahedralMesh read_tetrahedral_mesh(const std::string& path) {
  return read_tetrahedral_file(path).mesh;
}

/// Writes a Gmsh 4.1 text file whose numbers give back the same doubles. The file appears complete
/// or not at all. Throws InputError when it cannot be written.
void write_msh(const std::string& path, const TetrahedralMesh& mesh);

}  // namespace pliant
