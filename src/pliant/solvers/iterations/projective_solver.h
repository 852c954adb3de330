#pragma once

#include "pliant/core/solver.h"
#include "pliant/solvers/checks/error_control.h"
#include "pliant/solvers/checks/error_watch.h"
#include "pliant/solvers/checks/impulse_imbalance.h"
#include "pliant/solvers/checks/momentum_balance.h"
#include "pliant/solvers/checks/step_energy.h"

namespace pliant {

/// What all solvers of a projective system share: predict, let the constraints look, solve, take
/// the velocities from the displacement.
class ProjectiveSolver : public Solver {
 public:
  void prepare(System& system, double dt) final;
  void step(System& system, double dt, StepReport& report) final;
  void begin_step(System& system, double dt, StepReport& report) final;
  void finish_step(System& system, double dt, StepReport& report) final;
  void save(StateArchive& numbers) const final;
  void load(StateArchive& numbers) final;
  bool takes_time_integration() const override { return is_implicit(); }
  bool held_back() const final { return held_back_; }
  /// Whether its steps are those of implicit Euler, so that they can be told how far off they are.
  bool is_implicit() const override { return true; }

 protected:
  /// `rule` of a solver that iterates, and what an asked error chooses of it.
  explicit ProjectiveSolver(const StopRule& rule = {},
                            ErrorControl::By by = ErrorControl::By::kIterations)
      : control_(rule, by) {}
  /// Whether the rule asks for an error, and not for what its iterations come to.
  bool asks_for_error() const { return control_.is_on(); }
  /// The effective step that it is prepared for [s].
  double prepared_step() const { return dt_; }
  /// For the running step.
  const StopRule& rule() const { return control_.rule(); }
  virtual void save_learned(StateArchive& /*numbers*/) const {}
  virtual void load_learned(StateArchive& /*numbers*/) {}

  /// The system's structure or the time step changed.
  virtual void prepare_system(const ProjectiveSystem& system, double dt) = 0;
  /// Adds to `forces` [N], which hold the external ones, what the prediction shall also contain.
  virtual void add_predicted_forces(const ProjectiveSystem&, Forces& /*forces*/) const {}
  /// Moves particles that the prediction does not, before anything asks where all will be.
  virtual void move_others(ProjectiveSystem& /*system*/, double /*dt*/) {}
  /// After all else in a step: their velocities, and what these change of others'.
  virtual void end_others(ProjectiveSystem& /*system*/, double /*dt*/) {}
  /// What of solve() comes before the work that several solvers share.
  virtual void begin_solve(ProjectiveSystem& /*system*/, double /*dt*/, StepReport& /*report*/) {}
  /// What an iteration costs, in those of a solver on the CPU.
  virtual double iteration_price() const { return 1.0; }
  /// The residual that belongs to an error of positions, over that error. After prepare_system().
  virtual double residual_share(const ProjectiveSystem& /*system*/) const { return 1.0; }
  /// Whether its iterations may leave momentum that no force gave.
  virtual bool loses_momentum(const ProjectiveSystem& /*system*/) const { return is_implicit(); }
  /// Whether energies can be had on the CPU at a small part of a step's cost.
  virtual bool guards_energy() const { return is_implicit(); }
  /// Whether its forces and displacements may tell different momenta.
  virtual bool corrects_velocities(const ProjectiveSystem& /*system*/) const {
    return is_implicit();
  }
  /// Whether its steps may end with momentum that no force tells, of equations that were not quite
  /// solved, and not because they went less far than forces would take them.
  virtual bool leaves_momentum() const { return is_implicit(); }
  /// As a share of the motion: velocities are given what is left of momentum up to that, where they
  /// are not corrected anyway.
  virtual double most_momentum_left() const { return 1.0; }
  bool estimates_error() const { return is_implicit() && error_.suits(); }
  /// What to do about inaccurate steps.
  virtual std::string_view cure() const {
    return "take more iterations, a smaller time step, or lbfgs or newton (`pliant study advise` "
           "compares them)";
  }
  /// Moves `system.particles.x` from the prediction to the solution.
  virtual void solve(ProjectiveSystem& system, double dt, StepReport& report) = 0;

  static void reset_constraints(ProjectiveSystem& system);
  static void relax_constraints(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                StepReport& report);
  /// Whether iterations that came to their end moved into each other what no constraint saw coming,
  /// and have to go on.
  static bool finds_more(ProjectiveSystem& system, StepReport& report);
  /// After the iterations: restores momentum, keeps energy from growing, and makes the final
  /// projections of constraints.
  void end_step(ProjectiveSystem& system, const Eigen::VectorXd& mobility, StepReport& report);

  /// Whether a condition of a constraint carries force.
  static bool meets_contact(const ProjectiveSystem& system);
  /// Whether the step ends with more energy than it can, where it ends now.
  bool gains_energy(ProjectiveSystem& system, StepReport& report);
  /// The same later in the step.
  bool still_gains_energy(ProjectiveSystem& system, StepReport& report);
  MomentumBalance& momentum() { return momentum_; }

 private:
  friend class LockstepSolver;  // takes the iterations of others in turn

  /// What it learned, where another run begins.
  void forget();
  void tell_laws(const ProjectiveSystem& system, double dt, StepReport& report);
  void find_velocities(ProjectiveSystem& system, double dt, StepReport& report);
  static void predict(ProjectiveSystem& system, double dt);
  void final_projections(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                         StepReport& report);
  static void alternating_projections(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                      StepReport& report);
  static bool limit_displacements(ProjectiveSystem& system, StepReport& report);
  /// Lets free bodies go on as rigid ones, with as much of their change of shape as the step's
  /// energy allows. False: that gains energy too, or cannot be, and nothing changed.
  bool stiffen(ProjectiveSystem& system, const Eigen::VectorXd& mobility);
  /// Where the step gains energy by its final projections: the same without a change of shape. It
  /// goes less far where that gains energy too.
  void end_rigidly(ProjectiveSystem& system, const Eigen::VectorXd& mobility, StepReport& report);

  Positions wanted_;  // of the running step
  Positions found_;   // of the running step, by its iterations
  ErrorControl control_;
  ErrorWatch error_;
  MomentumBalance momentum_;
  ImpulseImbalance imbalance_;
  StepEnergy guard_;
  bool is_guarded_ = false;  // the running step
  bool held_back_ = false;   // the running step, by the guard
  double dt_ = 0.0;          // [s]
};

/// Names of the models that are a ProjectiveSystem.
const std::vector<std::string>& projective_models();
/// Those of them that deform: linear corrections of all particles at once do not find the forces of
/// an impact that turns a rigid body.
const std::vector<std::string>& deformable_models();

}  // namespace pliant
