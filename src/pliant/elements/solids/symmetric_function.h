#pragma once

#include <Eigen/Core>

namespace pliant {

/// Eigenvalues λ₀ ≥ λ₁ ≥ λ₂ of a symmetric 3x3 matrix in closed form (Smith 1961, "Eigenvalues of a
/// symmetric 3 x 3 matrix"). Their sums and products are right to round-off; two that nearly agree
/// may each be off by √ε of the spread, in opposite directions.
Eigen::Vector3d symmetric_eigenvalues(const Eigen::Matrix3d& s);

/// Q diag(h) Qᵀ for S = Q diag(λ) Qᵀ, without Q: Newton's interpolation polynomial of a smooth
/// function with the values hₖ and the slopes h'ₖ at λₖ, taken at S. `lambda` is what
/// symmetric_eigenvalues() gave; where two of them nearly agree, Hermite's polynomial through their
/// middle does not see how far each is off.
Eigen::Matrix3d symmetric_function(const Eigen::Matrix3d& s, const Eigen::Vector3d& lambda,
                                   const Eigen::Vector3d& h, const Eigen::Vector3d& slope);

}  // namespace pliant
