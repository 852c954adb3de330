#pragma once

#include "pliant/models/reduced/integrators/integrator.h"
#include "pliant/models/reduced/integrators/newton_iteration.h"

namespace pliant {

/// The thesis's implicit-explicit integrator (equations 4.3.31 and 4.3.32, algorithm 2), its
/// missing h and wrong sign mended. Coordinates with fᵢ = √λᵢ/(2π) < split/h are explicit, the
/// others implicit, and each component of R goes with its coordinate:
///   p⁺ = p + h f - h (R_low(q) + D p_low),
///   q' = q + h (p⁺ + p')/2,  p' = p⁺ - h (R_high(q̄) + D v),  q̄ = (q + q')/2, v = (q' - q)/h,
/// by Newton's method over the implicit coordinates alone. R's components couple all coordinates,
/// so this is no split of a potential; and an explicit coordinate needs h ω < 2, which is f < 1/(π
/// h). So it can blow up: it is here to be compared with.
class ImexThesis final : public Integrator {
 public:
  ImexThesis(double split, NewtonOptions options) : split_(split), options_(options) {}
  std::string_view name() const override { return "imex_thesis"; }
  int explicit_count() const { return low_; }
  static SolverRegistry::Entry entry();

 private:
  void prepare_step(const ReducedSystem& system, double h) override;
  void advance(ReducedSystem& system, double h, StepReport& report) override;

  double split_;
  NewtonOptions options_;
  NewtonIteration newton_;
  int low_ = 0;  // coordinates before this one are explicit
  Eigen::VectorXd damping_, next_, high_, r_, q_mid_;
  Eigen::MatrixXd k_;
  QuarticPotential::Workspace space_;
};

}  // namespace pliant
