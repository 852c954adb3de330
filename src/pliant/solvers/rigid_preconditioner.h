#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "pliant/solvers/constraint_rows.h"
#include "pliant/solvers/rigid_modes.h"

namespace pliant {

/// Preconditioner of the equations J B Jᵀ + C of constraints: each row answers by its own
/// compliance e, and all of them together move whole components,
///   (E + F S⁻¹ Fᵀ)⁻¹ = E⁻¹ − E⁻¹ F (S + Fᵀ E⁻¹ F)⁻¹ Fᵀ E⁻¹,  F = J P, S = Pᵀ M P / h²
/// (Woodbury). A stiff body's contacts are compliant by their inertia alone, which is what makes
/// the equations badly conditioned without it. With very many components it is E⁻¹ alone.
class RigidPreconditioner {
 public:
  void prepare(const ConstraintRows& rows, const Eigen::VectorXd& mobility,
               const RigidModes& modes);
  void apply(const Eigen::VectorXd& residual, Eigen::VectorXd& preconditioned);

 private:
  using Vector6 = RigidModes::Vector6;
  /// A row of F has the motions of two components at the most: a point's, and that of another.
  struct Row {
    double inverse = 0.0;  // 1/e [N/m]
    int bodies[2] = {-1, -1};
    Vector6 motions[2] = {Vector6::Zero(), Vector6::Zero()};
  };
  static void add_motion(int body, const Vector6& motion, Row& row);

  std::vector<Row> rows_;
  bool has_bodies_ = false;
  Eigen::MatrixXd matrix_;  // S + Fᵀ E⁻¹ F
  Eigen::LDLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd sums_;
};

}  // namespace pliant
