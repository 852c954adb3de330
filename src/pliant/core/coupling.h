#pragma once

#include <Eigen/Core>
#include <string_view>

#include "pliant/core/particles.h"

namespace pliant {

struct StepReport;

/// A nonlinear condition on positions that no element set expresses: contact with obstacles, air
/// in a sealed volume. Every solver treats it the same way: after each of its updates the coupling
/// moves particles by mobility * force and keeps the force as its multiplier.
class Coupling {
 public:
  virtual ~Coupling() = default;
  virtual std::string_view name() const = 0;

  /// `particles.x_start` is where the step began, `particles.x` the predicted end.
  virtual void begin_step(const Particles& particles, double dt) = 0;
  /// Solvers whose update starts anew from all forces (Jacobi) call this before each relax(),
  /// those that accumulate displacements (XPBD) once a step.
  virtual void reset_multipliers() = 0;
  /// Moves x[i] by mobility[i] * force [m/N], implicitly in x. A fixed particle has mobility 0.
  virtual void relax(const Eigen::VectorXd& mobility, Positions& x) = 0;
  /// Last word after the solver's iterations, for conditions that must hold exactly.
  virtual void finish(const Eigen::VectorXd& /*mobility*/, Positions& /*x*/) {}
  virtual void report(StepReport& /*report*/) const {}
};

}  // namespace pliant
