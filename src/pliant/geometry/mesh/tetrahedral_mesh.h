#pragma once

#include <Eigen/Core>
#include <string>

namespace pliant {

constexpr int kMaxTetrahedra = 10'000'000;

struct TetrahedralMesh {
  Eigen::Matrix3Xd vertices;  ///< 3 x n [m]
  /// 4 x m vertex indices a, b, c, d with (b - a) x (c - a) . (d - a) > 0: seen from d, the first
  /// three run clockwise.
  Eigen::Matrix4Xi tetrahedra;
};

/// m volumes [m³], negative where a tetrahedron's winding is inverted.
Eigen::VectorXd volumes(const TetrahedralMesh& mesh);

/// n volumes [m³]: a quarter of the adjacent tetrahedra's; they sum to the mesh's. Times a density
/// they are lumped masses.
Eigen::VectorXd vertex_volumes(const TetrahedralMesh& mesh);

/// The faces with one tetrahedron only, 3 x f vertex indices, counter-clockwise seen from outside,
/// in the order of their tetrahedra.
Eigen::Matrix3Xi boundary_triangles(const TetrahedralMesh& mesh);

/// Throws InputError, its message beginning with `where` (a file or scene field), when the mesh
/// - has no vertices or no tetrahedra, or more than kMaxTetrahedra tetrahedra;
/// - has a vertex that is not finite, or an index outside [0, vertices);
/// - has a flat tetrahedron: a height below 1e-10 of its longest edge;
/// - has an inverted tetrahedron: negative volume (fix_winding() may mend that);
/// - has a tetrahedron twice, or a vertex in no tetrahedron;
/// - has a face with more than two tetrahedra, or with two on the same side of it (they overlap).
/// The message names the first offenders and how many there are.
void validate(const TetrahedralMesh& mesh, const std::string& where);

/// Reverses the winding of every tetrahedron with negative volume and returns how many there were.
/// Where tetrahedra really overlap, validate() still refuses the result.
int fix_winding(TetrahedralMesh& mesh);

struct BlockOptions {
  Eigen::Vector3d size = Eigen::Vector3d::Ones();   ///< edge lengths [m]; positive and finite
  Eigen::Vector3i cells = Eigen::Vector3i::Ones();  ///< along x, y, z; at least 1
};

/// A box centred at the origin; vertex (k (cells_y + 1) + j) (cells_x + 1) + i lies at i along x, j
/// along y and k along z. Each cell is cut into five tetrahedra, one in the middle on every other
/// corner and one at each corner left; neighbouring cells are mirror images, so that their faces
/// match and a block with even numbers of cells is its own mirror image in x, y and z. Throws
/// InputError, naming the field and its range, for options outside their range or more than
/// kMaxTetrahedra tetrahedra.
TetrahedralMesh make_block(const BlockOptions& options);

}  // namespace pliant
