#pragma once

#include "pliant/core/solver.h"
#include "pliant/solvers/error_control.h"
#include "pliant/solvers/error_watch.h"

namespace pliant {

/// What all solvers of a projective system share: predict, let the couplings look, solve, take the
/// velocities from the displacement.
class ProjectiveSolver : public Solver {
 public:
  void prepare(System& system, double dt) final;
  void step(System& system, double dt, StepReport& report) final;
  void begin_step(System& system, double dt, StepReport& report) final;
  void finish_step(System& system, double dt, StepReport& report) final;
  void save(SavedNumbers& numbers) const final;
  void load(SavedNumbers& numbers) final;

 protected:
  /// `rule` of a solver that iterates.
  explicit ProjectiveSolver(const StopRule& rule = {}) : control_(rule) {}
  /// For the running step.
  const StopRule& rule() const { return control_.rule(); }
  virtual void save_learned(SavedNumbers& /*numbers*/) const {}
  virtual void load_learned(SavedNumbers& /*numbers*/) {}

  /// The system's structure or the time step changed.
  virtual void prepare_system(const ProjectiveSystem& system, double dt) = 0;
  /// Adds to `forces` [N], which hold the external ones, what the prediction shall also contain.
  virtual void add_predicted_forces(const ProjectiveSystem&, Forces& /*forces*/) const {}
  /// What of solve() comes before the work that several solvers share.
  virtual void begin_solve(ProjectiveSystem& /*system*/, double /*dt*/, StepReport& /*report*/) {}
  /// Whether its steps are those of implicit Euler, so that they can be told how far off they are.
  virtual bool is_implicit() const { return true; }
  /// What an iteration costs, in those of a solver on the CPU.
  virtual double iteration_price() const { return 1.0; }
  bool estimates_error() const { return is_implicit() && error_.suits(); }
  /// What to do about inaccurate steps.
  virtual std::string_view cure() const {
    return "take more iterations, a smaller time step, or lbfgs or newton (`pliant study advise` "
           "compares them)";
  }
  /// Moves `system.particles.x` from the prediction to the solution.
  virtual void solve(ProjectiveSystem& system, double dt, StepReport& report) = 0;

  static void reset_couplings(ProjectiveSystem& system);
  static void relax_couplings(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                              StepReport& report);
  void finish_couplings(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                        StepReport& report);

 private:
  static void predict(ProjectiveSystem& system, double dt);
  static void settle_couplings(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                               StepReport& report);
  static bool advance_couplings(ProjectiveSystem& system, StepReport& report);

  Positions wanted_;  // of the running step
  ErrorControl control_;
  ErrorWatch error_;
};

/// Names of the models that are a ProjectiveSystem.
const std::vector<std::string>& projective_models();

}  // namespace pliant
