#pragma once

#include "pliant/core/system/system.h"
#include "pliant/solvers/components/pieces.h"

namespace pliant {

struct StepReport;

/// One step of implicit Euler as a minimisation (Bouaziz et al. 2014, eq. 5):
///   φ(x) = 1/(2h²) |M^½ (x − y)|² + E(x),  y the prediction,
/// and how far from its minimum, under the constraints' conditions, a state is.
class StepObjective {
 public:
  void prepare(const ProjectiveSystem& system, double dt);
  /// The system's positions are the prediction y.
  void begin_step(const ProjectiveSystem& system) { begin_step(system.particles.x); }
  void begin_step(const Positions& predicted);

  /// Of some particles from `first` on, another y [m].
  void set_predicted(int first, const Eigen::Ref<const Positions>& predicted) {
    predicted_.middleCols(first, predicted.cols()) = predicted;
  }

  /// φ at the present positions [J].
  double value(const ProjectiveSystem& system) const;
  /// r = −∇φ = M/h² (y − x) + f(x) at the present positions, 0 for a fixed particle [N].
  void forces(const ProjectiveSystem& system, Forces& r, StepReport& report) const;
  /// |D^−½ f|, D the diagonal of the projective matrix.
  double norm(const Forces& f) const;
  /// The norm of r and the constraints' forces together over the largest of its parts in the first
  /// two of a step's `iteration`s, counted from 1, of that piece of the system where it is largest;
  /// 0 where only round-off is left. `violations` are what constraints miss of each particle,
  /// squared [J]; empty: nothing.
  double relative_residual(const ProjectiveSystem& system, const Forces& r, int iteration,
                           const Eigen::VectorXd& violations = {});

  /// The norm, of all particles, that relative_residual() last compared, also of round-off.
  double last_residual() const { return last_residual_; }
  /// Whether forces of that norm are no more than round-off of this step's positions.
  bool is_round_off(double size) const { return size <= round_off_; }
  const Pieces& pieces() const { return pieces_; }
  const Eigen::VectorXd& inertia() const { return inertia_; }    ///< m/h² [N/m]
  const Eigen::VectorXd& diagonal() const { return diagonal_; }  ///< D [N/m]
  /// Largest D h²/m of a free particle: how many times stiffer it is than its inertia.
  double stiffness_ratio() const { return stiffness_ratio_; }

 private:
  /// Squares of the norms of `f` on each piece, and of what is missed besides.
  void square(const Forces& f, const Eigen::VectorXd& missed, Eigen::VectorXd& squares) const;
  void take_scales(const Forces& f);
  /// The largest residual of a piece over its scale.
  double largest_share() const;

  Eigen::VectorXd inertia_;
  Eigen::VectorXd diagonal_;
  double stiffness_ratio_ = 1.0;
  Positions predicted_;
  Forces balance_;  // r with the constraints' forces added
  Pieces pieces_;
  Eigen::VectorXd residuals_, scales_;  // of each piece, squared [J]
  Eigen::VectorXd diagonals_;           // sums of D [N/m]
  double last_residual_ = 0.0;
  double reach_ = 0.0;      // how far from the origin particles are [m]
  double round_off_ = 0.0;  // norms up to this one are none
};

}  // namespace pliant
