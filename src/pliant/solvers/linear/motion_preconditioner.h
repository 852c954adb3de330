#pragma once

#include <vector>

#include "pliant/core/system/system.h"
#include "pliant/math/dense_factors.h"
#include "pliant/solvers/components/rigid_modes.h"
#include "pliant/solvers/constrained/point_constraint_rows.h"

namespace pliant {

/// Preconditioner of the equations J B Jᵀ + C of constraints: each row answers by its own
/// compliance e, and all of them together move whole components and the coordinates of reduced
/// bodies,
///   (E + F S⁻¹ Fᵀ)⁻¹ = E⁻¹ − E⁻¹ F (S + Fᵀ E⁻¹ F)⁻¹ Fᵀ E⁻¹,
/// with F = J P, S = Pᵀ M P / h² of components, and F = J U, S the inverse response of coordinates
/// (Woodbury). A stiff body's contacts are compliant by their inertia alone, which is what makes
/// the equations badly conditioned without it. With very many components these are left out.
class MotionPreconditioner {
 public:
  /// `answers` [m/N] are those of particles that no motion here stands for; `responders` are the
  /// system's.
  void prepare(const PointConstraintRows& rows, const Eigen::VectorXd& answers,
               const RigidModes& modes, const std::vector<ProjectiveSystem::Responder>& responders);
  void apply(const Eigen::VectorXd& residual, Eigen::VectorXd& preconditioned);

 private:
  using ConstMotion = Eigen::Map<const Eigen::VectorXd>;
  /// What moves together, and where its unknowns begin.
  struct Unknowns {
    Eigen::Index begin = 0, size = 0;
  };
  /// A row of F has two motions at the most: a point's, and that of another.
  struct Row {
    double inverse = 0.0;  // 1/e [N/m]
    int movers[2] = {-1, -1};
    std::size_t motions[2] = {0, 0};  // where these begin in motions_
  };
  void list_movers(const RigidModes& modes,
                   const std::vector<ProjectiveSystem::Responder>& responders);
  /// Room for what row has of `mover`; null: it has two others.
  double* motion_of(int mover, Row& row);
  ConstMotion motion(const Row& row, int k) const;
  /// The same of a mover of six unknowns, as most are: faster, since the compiler knows their
  /// number.
  RigidModes::Vector6 rigid_motion(const Row& row, int k) const;
  void add_row(const Row& row);

  std::vector<Row> rows_;
  std::vector<Unknowns> movers_;  // components, where there are few, then responders
  int components_ = 0;            // of movers_
  std::vector<double> motions_;
  Eigen::MatrixXd gradient_;  // of a particle of a responder
  Eigen::MatrixXd matrix_;    // S + Fᵀ E⁻¹ F
  DenseLdlt factor_;
  Eigen::VectorXd sums_;
};

}  // namespace pliant
