#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "pliant/models/reduced/linear_modes.h"

namespace pliant {

/// `done` of `total` is done; `what` runs now. False asks to stop.
using ReduceProgress = std::function<bool(double done, double total, const std::string& what)>;

/// Modal derivatives Φᵢⱼ = -K⁻¹ H[Ψᵢ, Ψⱼ], i <= j, columns in the order (0,0), (0,1), (1,1), (0,2),
/// ...: the second-order part of the static response (Barbič and James 2005, section 4.2).
Eigen::MatrixXd modal_derivatives(const StvkBody& body, const LinearModes& modes,
                                  const StaticResponse& response, const ReduceProgress& progress);

/// A mass-orthonormal basis in which the stiffness at rest is diagonal.
struct ReducedBasis {
  Eigen::MatrixXd u;       ///< U: size x r, Uᵀ M U = I
  Eigen::VectorXd lambda;  ///< r, rising: Uᵀ K(0) U = diag(λ) [1/s²]
};

/// The `rank` directions that hold most of Ψᵢ λ₁/λᵢ and Φᵢⱼ λ₁²/(λᵢ λⱼ) in the norm of the mass
/// (mass-PCA; Barbič and James 2005, section 4.3), rotated so that K(0) is diagonal. Throws
/// InputError when these do not span so many directions.
ReducedBasis mass_pca(const LinearModes& modes, const Eigen::MatrixXd& derivatives,
                      const Eigen::SparseMatrix<double>& stiffness,
                      const Eigen::SparseMatrix<double>& mass, int rank);

/// Orthonormalises any independent columns and diagonalises K(0).
ReducedBasis diagonalise(const Eigen::MatrixXd& columns,
                         const Eigen::SparseMatrix<double>& stiffness,
                         const Eigen::SparseMatrix<double>& mass);

}  // namespace pliant
