#pragma once

#include "pliant/models/reduced/integrators/integrator.h"
#include "pliant/models/reduced/integrators/newton_iteration.h"

namespace pliant {

/// Newmark's method with β = 1/4, γ = 1/2 (thesis equations 3.4.10 to 3.4.12):
///   q' = q + h p + h²/4 (a + a'),  p' = p + h/2 (a + a'),  a' = f - R(q') - D p'.
/// With one iteration and tolerance 0 the step is linearised about q, as real-time codes do; a'
/// then is what the first of these equations says.
class Newmark final : public Integrator {
 public:
  explicit Newmark(NewtonOptions options) : options_(options) {}
  std::string_view name() const override { return "newmark"; }
  static SolverRegistry::Entry entry();

 private:
  void prepare_step(const ReducedSystem& system, double h) override;
  void advance(ReducedSystem& system, double h, StepReport& report) override;

  NewtonOptions options_;
  NewtonIteration newton_;
  Eigen::VectorXd damping_, a_, next_, r_;
  Eigen::VectorXd known_q_, known_p_, known_force_;  // where a_ holds
  QuarticPotential::Workspace space_;
};

}  // namespace pliant
