#pragma once

#include "pliant/solvers/projective_matrix.h"

namespace pliant {

/// How far one Jacobi iteration x += gamma D^-1 r may go, D the diagonal of A.
struct Relaxation {
  double largest_eigenvalue = 0.0;  ///< of D^-1 A
  double gamma = 0.0;               ///< under-relaxation, below 2 / largest_eigenvalue
  Eigen::VectorXd mobility;         ///< gamma D^-1, 0 for a fixed particle [m/N]
};

/// gamma = 1.8 / lambda_max, lambda_max from Lanczos iterations on D^-1 A, bounded by the absolute
/// row sums (Gershgorin). Then no iteration raises the step's objective, whatever the mesh: slivers
/// and obtuse elements only make gamma smaller.
Relaxation make_relaxation(const SparseRows& a, const Particles& particles);

}  // namespace pliant
