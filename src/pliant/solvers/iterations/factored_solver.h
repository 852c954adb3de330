#pragma once

#include <cmath>

#include "pliant/solvers/checks/rigid_bend.h"
#include "pliant/solvers/components/rigid_modes.h"
#include "pliant/solvers/constrained/constrained_correction.h"
#include "pliant/solvers/constrained/equality_constrained_correction.h"
#include "pliant/solvers/constrained/touched_inverse.h"
#include "pliant/solvers/iterations/best_iterate.h"
#include "pliant/solvers/iterations/implicit_euler.h"
#include "pliant/solvers/iterations/relaxation.h"
#include "pliant/solvers/linear/cholesky.h"

namespace pliant {

/// Solvers that correct all particles at once by a factored matrix. What constraints hold is kept
/// by the correction; where there are any, Jacobi iterations after it let them find their forces:
/// one, and twice as many each time the residual did not fall, since contacts that come and go from
/// one correction to the next may do so for ever. Where conditions contradict each other, as a
/// limit to stretch and a hand in its way, what the correction takes for their answer may lie ten
/// cells off: one that makes the objective much worse is taken back.
///
/// Where all constraints let their multipliers be found (contact and friction with obstacles), each
/// correction finds them with the displacement instead, and there are no Jacobi iterations.
class FactoredSolver : public ImplicitEulerSolver {
 public:
  InLockstep in_lockstep() const final { return InLockstep::kCorrections; }
  /// Whether its corrections have the constraints in their matrix.
  virtual bool has_constraints_in_matrix() const { return false; }
  /// How far a contact gives way in one correction, as a share of how far its own force moves it.
  void set_contact_compliance(double share) { constrained_.set_compliance(share); }
  /// What a correction may leave of the change of contact forces, as a share of it.
  void set_contact_accuracy(double share) { constrained_.set_accuracy(share); }

 protected:
  explicit FactoredSolver(const StopRule& rule, ErrorControl::By by = ErrorControl::By::kIterations)
      : ImplicitEulerSolver(rule, by) {}

  void prepare_iterations(const ProjectiveSystem& system) override;
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  void judge_last_iteration(ProjectiveSystem& system, StepReport& report) final;
  void go_on() override;
  void choose_end(ProjectiveSystem& system, StepReport& report) final;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;
  void find_squared_violations(ProjectiveSystem& system, Eigen::VectorXd& violations) final;
  bool ends_at_round_off() const final { return finds_multipliers_ || rows_.are_met(); }
  std::string_view cure() const final {
    return "take more iterations or a smaller time step; newton iterates to convergence";
  }
  // Where it finds multipliers, it answers forces by the inertia of whole bodies itself.
  bool loses_momentum(const ProjectiveSystem& system) const override {
    return !may_find_multipliers(system);
  }
  bool corrects_velocities(const ProjectiveSystem& system) const final {
    return !may_find_multipliers(system);
  }
  bool begins_rigidly(const ProjectiveSystem& system) const final {
    return !may_find_multipliers(system);
  }
  bool asks_constraints_first() const final { return !finds_multipliers_; }
  const Eigen::VectorXd& mobility() const final { return relaxation_.mobility; }

  /// x -> x + d for forces(), d under the constraint rows, `p_inverse` an
  /// approximate inverse of the Hessian. Returns the length of the step.
  double correct(ProjectiveSystem& system, const LinearOperator& p_inverse, StepReport& report);
  /// Of a solver that calls correct(), before that: whether iterations went astray, so that x and
  /// the multipliers are those of the best one again, with forces() there.
  bool goes_astray(ProjectiveSystem& system, StepReport& report);
  /// Whether the present iteration is under constraints whose multipliers are found with it.
  bool finds_multipliers(const ProjectiveSystem& system) const;

  /// Moves x along the correction as far as that lowers φ − λᵀ J x, which it descends.
  double search_along(ProjectiveSystem& system);
  ConstrainedCorrection& constrained() { return constrained_; }
  const ConstrainedCorrection& constrained() const { return constrained_; }
  /// v <- A⁻¹ v, of a solver that calls correct().
  virtual void solve_matrix(Eigen::Matrix3Xd& /*v*/) {}
  /// For such a solver to call when it has factored its matrix; the factor has `nonzeros`.
  void prepare_touched(Eigen::Index nonzeros);
  /// What L-BFGS learned of the Hessian in this step; null: the solver corrects by A⁻¹ alone.
  virtual QuasiNewtonPairs* pairs() { return nullptr; }
  /// Whether the multipliers of all constraints can be found together with the displacement.
  bool may_find_multipliers(const ProjectiveSystem& system) const {
    return ConstrainedCorrection::suits(system) &&
           (has_constraints_in_matrix() || !ConstrainedCorrection::needs_matrix(system));
  }

  void return_to_best(ProjectiveSystem& system, StepReport& report);
  /// The unbalanced forces with those of the constraints, and what these hold. False where the last
  /// correction was taken back instead, and Jacobi iterations from before it took its place.
  bool begin_correction(ProjectiveSystem& system, StepReport& report);
  void end_correction(ProjectiveSystem& system, StepReport& report);
  /// Whether constraints held nothing when the correction began: it is that of the elements alone.
  bool is_unconstrained() const { return rows_.size() == 0 && held_.isZero(0.0); }
  /// Moves x from `start` along the correction by the largest step 1, 1/2, 1/4, ... that lowers
  /// φ + `more`(step) enough from what they are `before`, given their slope -`slope`; 0: none does.
  template <class More>
  double search_lower(ProjectiveSystem& system, const Positions& start, double before, double slope,
                      const More& more);
  /// Moves x from `start` along the correction by the largest step 1, 1/2, 1/4, ... that lowers
  /// the objective enough (Armijo). Returns 0 when none does.
  double search(ProjectiveSystem& system, const Positions& start);

  /// Whether the last correction promised less than round-off of the objective.
  bool is_search_blind() const { return is_search_blind_; }
  const Forces& balance() const { return balance_; }  ///< [N]
  const ConstraintRows& rows() const { return rows_; }
  Positions& correction() { return correction_; }  ///< d [m]
  const Positions& correction() const { return correction_; }
  EqualityConstrainedCorrection& equality_constrained() { return equality_constrained_; }

 private:
  static constexpr double kArmijo = 1e-4;
  static constexpr int kMaxHalvings = 30;
  // Differences of the objective below this share of it are round-off.
  static constexpr double kSearchRoundOff = 1e-14, kTooLittle = 1e-12;

  /// Begins with rigid bodies as bent as the forces of the last step bend them: each step ends with
  /// these in their own shape, and an iteration that only bends them again is lost.
  void bend_rigid_bodies(ProjectiveSystem& system);
  void ask_constraints(const ProjectiveSystem& system);
  bool is_much_worse(const ProjectiveSystem& system) const;
  void take_back(ProjectiveSystem& system, StepReport& report);
  void sweep(ProjectiveSystem& system, int times, StepReport& report);

  /// Makes own_answers_ that of A⁻¹ at the particles of the constraints.
  void update_own_answers(const PointConstraints& constraints);
  Relaxation relaxation_;
  Eigen::VectorXd contact_mobility_;  // of particles, to what constraints miss [m/N]
  RigidModes rigid_modes_;
  RigidBend rigid_bend_;
  ConstrainedCorrection constrained_;
  /// Of the system's responders: which particles constraints touch, and what these answer.
  void list_touched(const ProjectiveSystem& system, const PointConstraints& constraints);
  void keep_forces(const ProjectiveSystem& system, const Forces& v);
  void respond(const ProjectiveSystem& system, Positions& v);
  std::vector<std::vector<int>> touched_;  // by responder, their numbers there
  std::vector<Forces> on_touched_;         // [N]
  std::vector<bool> is_touched_;
  Eigen::VectorXd own_answers_;  // of particles to a force on them: of A⁻¹ where is_own_ [m/N]
  std::vector<bool> is_own_;
  std::vector<int> asked_;
  TouchedInverse touched_inverse_;
  bool finds_multipliers_ = false;
  int sweeps_ = 1;
  double smallest_balance_ = 0.0;  // of the step so far, in the objective's norm
  ConstraintRows rows_;
  EqualityConstrainedCorrection equality_constrained_;
  Forces balance_;
  Forces held_;  // of the constraints [N]
  Positions correction_;
  bool is_search_blind_ = false;
  bool is_on_trial_ = false;       // whether the last iteration made a correction
  double objective_before_ = 0.0;  // it [J]
  Positions before_;               // it [m]
  int taken_back_ = 0;             // corrections of the step
  BestIterate best_;               // of a solver that asks goes_astray()
};

template <class More>
double FactoredSolver::search_lower(ProjectiveSystem& system, const Positions& start, double before,
                                    double slope, const More& more) {
  Positions& x = system.particles.x;
  const double slack = kSearchRoundOff * std::abs(before);
  // Nothing tells how much better a full step is than a shorter one.
  is_search_blind_ = slope >= 0.0 && slope <= kTooLittle * std::abs(before);
  if (is_search_blind_) {
    x = start + correction_;
    return 1.0;
  }
  double step = 1.0;
  for (int k = 0; k < kMaxHalvings; ++k, step *= 0.5) {
    x = start + step * correction_;
    const double change = objective().value(system) - before + more(step);
    if (change <= -kArmijo * step * slope + slack) return step;
  }
  x = start;
  return 0.0;
}

}  // namespace pliant
