#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "pliant/models/reduced/elastic_factor.h"
#include "pliant/models/reduced/stvk_body.h"

namespace pliant {

/// The lowest vibrations K ψ = λ M ψ of a body at rest, and K⁻¹ on what is no rigid motion.
struct LinearModes {
  Eigen::MatrixXd shapes;  ///< Ψ: size x k, Ψᵀ M Ψ = I, by rising frequency
  Eigen::VectorXd lambda;  ///< k squared circular frequencies [1/s²]
  Eigen::MatrixXd rigid;   ///< size x (0 to 6) M-orthonormal rigid motions that the body can make
};

/// Rigid motions that no fixed vertex forbids, M-orthonormal: six for a free body, none where three
/// vertices that are not on one line are fixed.
Eigen::MatrixXd rigid_motions(const StvkBody& body, const Eigen::SparseMatrix<double>& mass);

/// The `count` lowest modes that are no rigid motions, by shift-invert Lanczos iterations
/// (Spectra). The sign of each is such that its largest entry is positive. Throws InputError when
/// the body has not so many, or the iterations do not converge.
LinearModes linear_modes(const StvkBody& body, const Eigen::SparseMatrix<double>& stiffness,
                         const Eigen::SparseMatrix<double>& mass, int count);

/// Static responses: K x = b for loads b without a resultant. Where the body can move rigidly, the
/// load's resultant is taken off with the forces of inertia that it causes, and x has no rigid
/// part.
class StaticResponse {
 public:
  StaticResponse(const Eigen::SparseMatrix<double>& stiffness,
                 const Eigen::SparseMatrix<double>& mass, const Eigen::MatrixXd& rigid);
  Eigen::VectorXd solve(const Eigen::VectorXd& load) const;

 private:
  const Eigen::SparseMatrix<double>& stiffness_;
  Eigen::MatrixXd rigid_;
  Eigen::MatrixXd rigid_momenta_;  // M R
  ElasticFactor factor_;
};

/// σ < 0, so small that K - σ M is as good as K, so large that it can be factored for a free body.
double regularising_shift(const Eigen::SparseMatrix<double>& stiffness,
                          const Eigen::SparseMatrix<double>& mass);

}  // namespace pliant
