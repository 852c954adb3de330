#include "pliant/models/reduced/integrators/midpoint.h"

#include <algorithm>
#include <cmath>

namespace pliant {

NewtonOutcome MidpointStep::advance(ReducedSystem& system, const Eigen::VectorXd& damping,
                                    double h) {
  // F(q̄) = 4/h² (q̄ - q) - 2/h p + 2/h D (q̄ - q) + R(q̄) - f
  const double inertia = 4.0 / (h * h);
  const auto evaluate = [&](const Eigen::VectorXd& q, Eigen::VectorXd& f, Eigen::MatrixXd& j) {
    system.potential.evaluate(q, r_, j, space_);
    f = (inertia + 2.0 / h * damping.array()) * (q - system.q).array();
    f += r_ - system.force - 2.0 / h * system.p;
    j.diagonal().array() += inertia + 2.0 / h * damping.array();
  };
  middle_ = system.q + 0.5 * h * system.p;
  const NewtonOutcome outcome = newton_.solve(evaluate, options_, middle_);
  system.p = 4.0 / h * (middle_ - system.q) - system.p;
  system.q = 2.0 * middle_ - system.q;
  return outcome;
}

void Midpoint::prepare_step(const ReducedSystem& system, double) {
  damping_ = system.damping_rates();
}

void Midpoint::advance(ReducedSystem& system, double h, StepReport& report) {
  report_newton(rule_.advance(system, damping_, h), rule_.options(), report);
}

SolverRegistry::Entry Midpoint::entry() {
  return {"midpoint",
          "implicit midpoint rule by Newton's method: symplectic, second order",
          newton_parameters("20", "1e-8"),
          {"reduced"},
          [](const Parameters& parameters) {
            return std::make_unique<Midpoint>(newton_options(parameters));
          }};
}

Reference::Reference(int substeps) : substeps_(substeps), rule_({30, 1e-13}) {}

void Reference::prepare_step(const ReducedSystem& system, double) {
  damping_ = system.damping_rates();
}

void Reference::advance(ReducedSystem& system, double h, StepReport& report) {
  const double substep = h / substeps_, gamma = 1.0 / (2.0 - std::cbrt(2.0));
  NewtonOutcome worst;
  worst.converged = true;
  for (int k = 0; k < substeps_; ++k) {
    for (const double share : {gamma, 1.0 - 2.0 * gamma, gamma}) {
      const NewtonOutcome outcome = rule_.advance(system, damping_, share * substep);
      worst.iterations += outcome.iterations;
      worst.residual = std::max(worst.residual, outcome.residual);
      worst.converged = worst.converged && outcome.converged;
    }
  }
  report_newton(worst, rule_.options(), report);
}

SolverRegistry::Entry Reference::entry() {
  return {"reference",
          "implicit midpoint composed to fourth order, converged to round-off, in substeps: the "
          "standard of the others",
          {integer_parameter("substeps", "8", 1, 10000, "of a step")},
          {"reduced"},
          [](const Parameters& parameters) {
            return std::make_unique<Reference>(parameters.integer("substeps"));
          }};
}

std::vector<ParameterSpec> newton_parameters(const std::string& iterations,
                                             const std::string& tolerance) {
  return {integer_parameter("iterations", iterations, 1, 1000, "Newton iterations a step, at most"),
          number_parameter("tolerance", "", tolerance, 0.0, 1.0,
                           "residual against the step's first at which they end; 0 takes them all "
                           "and judges nothing")};
}

NewtonOptions newton_options(const Parameters& parameters) {
  return {parameters.integer("iterations"), parameters.number("tolerance")};
}

void report_newton(const NewtonOutcome& outcome, const NewtonOptions& options, StepReport& report) {
  report.iterations = outcome.iterations;
  report.residual = outcome.residual;
  report.ended_by = outcome.converged ? EndedBy::kTolerance : EndedBy::kIterations;
  if (options.tolerance > 0.0 && !outcome.converged) {
    report.warn("not_converged: Newton's method did not reach its tolerance: take a smaller step");
  }
}

}  // namespace pliant
