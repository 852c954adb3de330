#pragma once

#include <Eigen/SparseCore>

#include "pliant/core/system/system.h"

namespace pliant {

/// Row-major, so that one row is what one particle gathers.
using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// A = M/h² + sum w S^T S, symmetric positive definite, n x n; it acts on x, y and z alike. Rows
/// and columns of fixed particles are those of the identity [N/m].
SparseRows projective_matrix(const ProjectiveSystem& system, double dt);

/// Sums of each row's absolute entries [N/m].
Eigen::VectorXd absolute_row_sums(const SparseRows& a);

/// 1 / diagonal, 0 for a fixed particle [m/N].
Eigen::VectorXd free_mobility(const Eigen::VectorXd& diagonal, const Particles& particles);

/// y = A x for each of the three coordinates.
void multiply(const SparseRows& a, const Positions& x, Positions& y);

}  // namespace pliant
