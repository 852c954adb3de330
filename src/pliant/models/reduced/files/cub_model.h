#pragma once

#include <string>

#include "pliant/models/reduced/reduced_model.h"

namespace pliant {

/// A dense matrix as the Vega FEM library writes it (matrixIO.h): i32 rows, i32 columns, then f64
/// column by column; little-endian. Throws InputError, naming the file, for one that is missing,
/// shorter or longer than its sizes say, or holds numbers that are not finite.
Eigen::MatrixXd read_vega_matrix(const std::string& path);

/// A body of that library: its polynomial (`.cub`, see read_cub()) and its basis over the vertices
/// of `mesh`, 3n x r. Vertices that the basis does not move are fixed. Throws InputError where the
/// files do not belong to each other or to the mesh, and for a basis that is not mass-orthonormal
/// with the material's density, to 1e-4: the polynomial holds for masses of 1.
ReducedModel make_cub_model(const std::string& cub, const std::string& basis,
                            const TetrahedralMesh& mesh, const ElasticMaterial& material,
                            const std::string& name);

/// Largest difference between the model's force and Uᵀ R(U q) of its mesh and material, over the
/// latter, at a few q that deform it by a tenth of its size.
double force_difference(const ReducedModel& model);

}  // namespace pliant
