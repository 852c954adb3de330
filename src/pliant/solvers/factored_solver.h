#pragma once

#include "pliant/solvers/cholesky.h"
#include "pliant/solvers/coupled_correction.h"
#include "pliant/solvers/implicit_euler.h"
#include "pliant/solvers/relaxation.h"

namespace pliant {

/// Solvers that correct all particles at once by a factored matrix. What couplings hold is kept by
/// the correction; where there are any, Jacobi iterations after it let them find their forces: one,
/// and twice as many each time the residual did not fall, since contacts that come and go from one
/// correction to the next may do so for ever. Where conditions contradict each other, as a limit to
/// stretch and a hand in its way, what the correction takes for their answer may lie ten cells off:
/// one that makes the objective much worse is taken back.
class FactoredSolver : public ImplicitEulerSolver {
 protected:
  explicit FactoredSolver(const StopRule& rule) : ImplicitEulerSolver(rule) {}

  void prepare_iterations(const ProjectiveSystem& system) override;
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  void judge_last_iteration(ProjectiveSystem& system, StepReport& report) final;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool asks_couplings_first() const final { return true; }
  const Eigen::VectorXd& mobility() const final { return relaxation_.mobility; }

  /// The unbalanced forces with those of the couplings, and what these hold. False where the last
  /// correction was taken back instead, and Jacobi iterations from before it took its place.
  bool begin_correction(ProjectiveSystem& system, StepReport& report);
  void end_correction(ProjectiveSystem& system, StepReport& report);
  /// Whether couplings held nothing when the correction began: it is that of the elements alone.
  bool is_uncoupled() const { return rows_.size() == 0 && held_.isZero(0.0); }
  /// Moves x from `start` along the correction by the largest step 1, 1/2, 1/4, ... that lowers
  /// the objective enough (Armijo). Returns 0 when none does.
  double search(ProjectiveSystem& system, const Positions& start);

  const Forces& balance() const { return balance_; }  ///< [N]
  const CouplingRows& rows() const { return rows_; }
  Positions& correction() { return correction_; }  ///< d [m]
  CoupledCorrection& coupled() { return coupled_; }

 private:
  void ask_couplings(const ProjectiveSystem& system);
  bool is_much_worse(const ProjectiveSystem& system) const;
  void take_back(ProjectiveSystem& system, StepReport& report);
  void sweep(ProjectiveSystem& system, int times, StepReport& report);

  Relaxation relaxation_;
  int sweeps_ = 1;
  double smallest_balance_ = 0.0;  // of the step so far, in the objective's norm
  CouplingRows rows_;
  CoupledCorrection coupled_;
  Forces balance_;
  Forces held_;  // of the couplings [N]
  Positions correction_;
  bool is_on_trial_ = false;       // whether the last iteration made a correction
  double objective_before_ = 0.0;  // it [J]
  Positions before_;               // it [m]
  int taken_back_ = 0;             // corrections of the step
};

}  // namespace pliant
