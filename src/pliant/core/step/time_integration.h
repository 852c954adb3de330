#pragma once

#include <string_view>

#include "pliant/core/body/particles.h"
#include "pliant/core/registry.h"

namespace pliant {

inline constexpr std::string_view kImplicitEuler = "implicit_euler";

/// How the end of a time step follows from the states before it. Solvers know one kind of step, of
/// implicit Euler: M (v - v*) / h* = f(x) with v = (x - x*) / h*. An integration says what x*, v*
/// and the effective step h* are, and what becomes of the state where such a step ends; a solver
/// knows not which it is. Holds no state: what it remembers is the particles' (MotionHistory).
class TimeIntegration {
 public:
  virtual ~TimeIntegration() = default;
  virtual std::string_view name() const = 0;
  /// Whether it is implicit Euler itself.
  virtual bool is_first_order() const { return false; }
  /// Before a step of `dt` [s] from `p.x` and `p.v`: sets `p.inertia` and returns the effective
  /// step [s]; 0 where it does not know enough of the step before, `p.history_before`.
  virtual double begin_step(Particles& p, double dt) const = 0;
  /// Whether the solver's step ends where the whole one does, so that constraints hold there.
  virtual bool ends_with_solver() const { return true; }
  /// Where it does not: from there to the end.
  virtual void end_step(Particles& /*p*/) const {}
  /// Where it does not: what takes the steps in which constraints may act, or what holds a body
  /// moves. It ends with the solver.
  virtual const TimeIntegration* in_contact() const { return nullptr; }
};

using TimeIntegrationRegistry = Registry<const TimeIntegration>;

}  // namespace pliant
