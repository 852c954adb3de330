#pragma once

#include <Eigen/Core>
#include <string>

#include "pliant/geometry/tetrahedral_mesh.h"

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

/// The points where the mesh's vertices [m] now are: 3 x n.
Eigen::Matrix3Xd embedded_positions(const Embedding& embedding, const Eigen::Matrix4Xi& tetrahedra,
                                    const Eigen::Matrix3Xd& vertices);

}  // namespace pliant
