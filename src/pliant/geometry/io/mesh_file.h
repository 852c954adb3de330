#ifndef PLIANT_GEOMETRY_MESH_FILE_H_
#define PLIANT_GEOMETRY_MESH_FILE_H_

#include <Eigen/Core>
#include <map>
#include <string>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

// Reads an OBJ, STL, PLY, glTF (.gltf, .glb) or COLLADA (.dae) file. All its triangle meshes become
// one; polygons are cut into triangles, node transforms and COLLADA's unit are applied, vertices at
// the same position are joined. Coordinates are single precision [m]. As in rviz, axes stay those
// of the file: COLLADA's <up_axis> is not applied.
//
// Throws InputError, naming the file, when it is missing, has another extension, cannot be read
// (truncated, garbage), holds no triangles (only points or lines), or more than kMaxTriangles.
// Does not judge the mesh otherwise: see validate().
TriangleMesh read_triangle_mesh(const std::string& path);

// The extension of a mesh file in lower case, without its dot. Throws InputError as
// read_triangle_mesh() does for a file that is missing or has another one.
std::string checked_mesh_extension(const std::string& path);

// Writes a binary little-endian PLY in single precision, with one float property a field (n values
// each). The file appears complete or not at all. Throws InputError when the file cannot be
// written, a field has another size than the vertices, or its name is not a word of [A-Za-z0-9_]
// other than x, y, z. `comment`, a line, is written into its header.
void write_ply(const std::string& path, const TriangleMesh& mesh,
               const std::map<std::string, Eigen::VectorXd>& fields = {},
               const std::string& comment = {});

// Writes an OBJ whose numbers give back the same doubles. The file appears complete or not at all.
// Throws InputError when it cannot be written. `comment`, a line, is its first one.
void write_obj(const std::string& path, const TriangleMesh& mesh, const std::string& comment = {});

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_MESH_FILE_H_
