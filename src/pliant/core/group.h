#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "pliant/core/step/integrated_step.h"
#include "pliant/core/system/joint_system.h"

namespace pliant {

struct Body;
class Group;
class Solver;

/// Makes what moves bodies whose solvers differ, iteration by iteration. Throws InputError where
/// these cannot go together.
using LockstepFactory = std::function<std::unique_ptr<Solver>(const Group& group)>;

/// Bodies that are moved together: one alone, or several that touch, each with a model, a state and
/// effects of its own. Where one solver moves all of them, they share it; what moves them tells
/// what it did in the report of the first.
class Group {
 public:
  explicit Group(Body& body);
  /// Of bodies whose systems are projective, or answer forces. They name this as their group from
  /// then on.
  Group(std::vector<Body*> bodies, LockstepFactory make_lockstep);
  ~Group();

  const std::vector<Body*>& bodies() const { return bodies_; }
  Body& first() const { return *bodies_.front(); }
  /// What the solver moves.
  System& system() const;
  /// Of several bodies; null for one alone.
  JointSystem* joint() const { return joint_.get(); }
  /// What moves them: their common solver, or what takes their solvers' iterations in turn.
  Solver& solver() const;

  /// Masses, pinned particles, elements, the time step or bodies' solvers changed.
  void prepare_solver(double dt);
  /// By what steps are integrated from now on; null: by implicit Euler, or as the solver does it.
  /// Throws InputError where the solver has an integration of its own, and then nothing changed.
  void set_time_integration(std::shared_ptr<const TimeIntegration> integration);
  /// Null: implicit Euler, or the solver's own.
  IntegratedStep* integrated() const { return integrated_.get(); }
  /// A step of `dt` [s], when the bodies' effects have told their forces, in two halves.
  void begin_step(double dt);
  void finish_step(double dt);
  /// Before the solver begins: what the bodies' effects and their users changed.
  void gather() const;
  /// After it: where it took the bodies.
  void hand_out() const;

 private:
  /// The bodies' solvers, each once.
  std::vector<Solver*> solvers() const;

  std::vector<Body*> bodies_;
  std::unique_ptr<JointSystem> joint_;
  LockstepFactory make_lockstep_;
  std::unique_ptr<Solver> lockstep_;  // null: one solver moves all
  std::vector<Solver*> in_step_;      // that it was made for
  std::unique_ptr<IntegratedStep> integrated_;
};

}  // namespace pliant
