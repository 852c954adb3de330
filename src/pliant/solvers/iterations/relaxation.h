#pragma once

#include "pliant/solvers/linear/projective_product.h"

namespace pliant {

/// How far one Jacobi iteration x += gamma D^-1 r may go, D the diagonal of A.
struct Relaxation {
  double largest_eigenvalue = 0.0;  ///< of D^-1 A
  double gamma = 0.0;               ///< under-relaxation, below 2 / largest_eigenvalue
  Eigen::VectorXd mobility;         ///< gamma D^-1, 0 for a fixed particle [m/N]

  /// Of I - gamma D^-1 A, whose smallest eigenvalue of D^-1 A is no less than 1/`stiffness_ratio`,
  /// at most.
  double spectral_radius(double stiffness_ratio) const;
};

/// Of D^-1 A, from above but for a chance of 1e-5: a few percent more than Lanczos iterations find,
/// bounded by the absolute row sums.
double largest_eigenvalue(const SparseRows& a);

/// gamma = min(1.8 / lambda_max, 2 / (lambda_max + lambda_min)), the eigenvalues from Lanczos
/// iterations on D^-1 A, lambda_max bounded by the absolute row sums (Gershgorin). Then no
/// iteration raises the step's objective, whatever the mesh: slivers and obtuse elements only make
/// gamma smaller; and where inertia rules, so that all eigenvalues are near 1, one iteration is
/// enough.
Relaxation make_relaxation(const SparseRows& a, const Particles& particles);
Relaxation make_relaxation(const ProjectiveProduct& a, const Particles& particles);

}  // namespace pliant
