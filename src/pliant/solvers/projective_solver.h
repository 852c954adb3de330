#pragma once

#include "pliant/core/solver.h"

namespace pliant {

/// What all solvers of a projective system share: predict, let the couplings look, solve, take the
/// velocities from the displacement.
class ProjectiveSolver : public Solver {
 public:
  void prepare(System& system, double dt) final;
  void step(System& system, double dt, StepReport& report) final;

 protected:
  /// The system's structure or the time step changed.
  virtual void prepare_system(const ProjectiveSystem& system, double dt) = 0;
  /// Adds to `forces` [N], which hold the external ones, what the prediction shall also contain.
  virtual void add_predicted_forces(const ProjectiveSystem&, Forces& /*forces*/) const {}
  /// Moves `system.particles.x` from the prediction to the solution.
  virtual void solve(ProjectiveSystem& system, double dt, StepReport& report) = 0;

  static void reset_couplings(ProjectiveSystem& system);
  static void relax_couplings(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                              StepReport& report);
  static void finish_couplings(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                               StepReport& report);

 private:
  static void predict(ProjectiveSystem& system, double dt);
};

/// Counts iterations and says when to stop and why.
class StopCheck {
 public:
  StopCheck(const StopRule& rule, StepReport& report) : rule_(rule), report_(report) {}
  /// True while another iteration is due.
  bool next();
  /// Whether the caller has to measure the running iteration's displacement.
  bool wants_displacement() const {
    return rule_.tolerance > 0.0 || report_.iterations == 1 ||
           report_.iterations == rule_.iterations;
  }
  /// `norm` of the running iteration's displacement [m].
  void set_displacement(double norm);

 private:
  const StopRule& rule_;
  StepReport& report_;
  Timer timer_;
  double first_ = 0.0;
  bool converged_ = false;
};

}  // namespace pliant
