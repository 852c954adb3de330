#pragma once

#include <Eigen/Core>
#include <string>

#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// Points that move with the tetrahedra around them.
struct Embedding {
  Eigen::VectorXi tetrahedron;  ///< n indices
  Eigen::Matrix4Xd weights;     ///< 4 x n barycentric coordinates; each column sums to 1
};

/// Finds for each of the 3 x n points [m] the tetrahedron that contains it (the first of several),
/// or, for a point outside the mesh, the tetrahedron behind the boundary's nearest triangle; its
/// weights are then partly negative. Throws InputError, its message beginning with `where`, for a
/// point that is not finite. The mesh must pass validate().
Embedding embed(const Eigen::Matrix3Xd& points, const TetrahedralMesh& mesh,
                const std::string& where = "embedding");

/// Writes the n points of an embedding to `points`, 3 x n [m], for the mesh's vertices where they
/// now are [m].
void carry(const Embedding& embedding, const Eigen::Matrix4Xi& tetrahedra,
           const Eigen::Matrix3Xd& vertices, Eigen::Ref<Eigen::Matrix3Xd> points);

/// The same as a new matrix.
Eigen::Matrix3Xd embedded_positions(const Embedding& embedding, const Eigen::Matrix4Xi& tetrahedra,
                                    const Eigen::Matrix3Xd& vertices);

}  // namespace pliant
