#pragma once

#include <string>

#include "pliant/models/reduced/integrators/integrator.h"

namespace pliant {

/// Explicit, second order, symplectic; stable while h ω < 2 for every frequency ω of the tangent:
///   p½ = p + h/2 (f - R(q)),  q' = q + h v with (1 + h D/2) v = p½,  p' = 2 v - p½ + h/2 (f -
///   R(q')).
/// Thesis equations 3.4.4 and 3.4.5, with damping by the midpoint rule.
class StoermerVerlet final : public Integrator {
 public:
  std::string_view name() const override { return "stoermer_verlet"; }
  static SolverRegistry::Entry entry();

 private:
  void prepare_step(const ReducedSystem& system, double h) override;
  void advance(ReducedSystem& system, double h, StepReport& report) override;

  Eigen::VectorXd drift_;  // 1/(1 + h D/2)
  std::string unstable_;   // what is said of steps that are too long; empty: they are not
  Eigen::VectorXd known_q_, r_;
  QuarticPotential::Workspace space_;
};

}  // namespace pliant
