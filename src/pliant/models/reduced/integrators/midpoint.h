#pragma once

#include "pliant/models/reduced/integrators/integrator.h"
#include "pliant/models/reduced/integrators/newton_iteration.h"

namespace pliant {

/// One step of the implicit midpoint rule, thesis equation 3.4.9: with q̄ = (q + q')/2
///   q' = q + h v,  v = (p + p')/2,  p' = p + h (f - R(q̄) - D v).
class MidpointStep {
 public:
  explicit MidpointStep(NewtonOptions options) : options_(options) {}
  NewtonOutcome advance(ReducedSystem& system, const Eigen::VectorXd& damping, double h);
  const NewtonOptions& options() const { return options_; }

 private:
  NewtonOptions options_;
  NewtonIteration newton_;
  Eigen::VectorXd middle_, r_;
  QuarticPotential::Workspace space_;
};

/// Implicit, second order, symplectic.
class Midpoint final : public Integrator {
 public:
  explicit Midpoint(NewtonOptions options) : rule_(options) {}
  std::string_view name() const override { return "midpoint"; }
  static SolverRegistry::Entry entry();

 private:
  void prepare_step(const ReducedSystem& system, double h) override;
  void advance(ReducedSystem& system, double h, StepReport& report) override;

  MidpointStep rule_;
  Eigen::VectorXd damping_;
};

/// The standard of the others: implicit midpoint, converged to round-off, in `substeps` of
/// the step, each of which is three steps γ, 1 - 2γ, γ of it with γ = 1/(2 - 2^⅓), which is of
/// fourth order (Yoshida 1990, "Construction of higher order symplectic integrators").
class Reference final : public Integrator {
 public:
  explicit Reference(int substeps);
  std::string_view name() const override { return "reference"; }
  static SolverRegistry::Entry entry();

 private:
  void prepare_step(const ReducedSystem& system, double h) override;
  void advance(ReducedSystem& system, double h, StepReport& report) override;

  int substeps_;
  MidpointStep rule_;
  Eigen::VectorXd damping_;
};

/// Parameters `iterations` and `tolerance` of Newton's method, and back.
std::vector<ParameterSpec> newton_parameters(const std::string& iterations,
                                             const std::string& tolerance);
NewtonOptions newton_options(const Parameters& parameters);
/// What Newton's method did, with a warning when it did not converge where it was asked to.
void report_newton(const NewtonOutcome& outcome, const NewtonOptions& options, StepReport& report);

}  // namespace pliant
