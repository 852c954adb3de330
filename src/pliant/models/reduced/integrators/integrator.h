#pragma once

#include "pliant/core/solver.h"
#include "pliant/models/reduced/reduced_system.h"

namespace pliant {

/// Advances a reduced system by one time step. Its state is the system's q and p alone: a swap in
/// motion keeps both.
class Integrator : public Solver {
 public:
  /// Throws std::bad_cast for a system that is not reduced: registries ask for the model first.
  void prepare(System& system, double dt) final;
  void step(System& system, double dt, StepReport& report) final;
  InLockstep in_lockstep() const final { return InLockstep::kStepsOfItsOwn; }

 protected:
  /// What the running step answers forces with. It is measured before the first step; integrators
  /// whose steps change keep it right.
  StepResponse response_;

 private:
  virtual void prepare_step(const ReducedSystem& system, double h) = 0;
  virtual void advance(ReducedSystem& system, double h, StepReport& report) = 0;
  /// Makes a step of a body at rest under a tiny force.
  void measure_response(ReducedSystem& system, double h);
};

/// trigonometric, imex_thesis, newmark, midpoint, stoermer_verlet, reference.
const SolverRegistry& integrator_registry();

}  // namespace pliant
