#include "pliant/models/reduced/integrators/imex_thesis.h"

#include <cmath>

#include "pliant/models/reduced/integrators/midpoint.h"

namespace pliant {

void ImexThesis::prepare_step(const ReducedSystem& system, double h) {
  damping_ = system.damping_rates();
  const Eigen::VectorXd& lambda = system.potential.lambda();
  low_ = 0;
  while (low_ < lambda.size() && std::sqrt(lambda[low_]) / (2.0 * M_PI) < split_ / h) ++low_;
}

void ImexThesis::advance(ReducedSystem& system, double h, StepReport& report) {
  const Eigen::Index low = low_, high = system.q.size() - low;
  system.potential.evaluate(system.q, r_, space_);
  r_.head(low) += damping_.head(low).cwiseProduct(system.p.head(low));
  system.p += h * system.force;
  system.p.head(low) -= h * r_.head(low);
  next_ = system.q + h * system.p;
  if (high == 0) {
    system.q = next_;
    report.iterations = 0;
    return;
  }
  // F(q') = q' - q - h p⁺ + h²/2 (R_high(q̄) + D v), divided by h²/2 to be of R's size.
  const double inertia = 2.0 / (h * h);
  const auto evaluate = [&](const Eigen::VectorXd& q, Eigen::VectorXd& f, Eigen::MatrixXd& j) {
    next_.tail(high) = q;
    q_mid_ = 0.5 * (system.q + next_);
    system.potential.evaluate(q_mid_, r_, k_, space_);
    const auto d = damping_.tail(high);
    f = inertia * (q - system.q.tail(high) - h * system.p.tail(high)) + r_.tail(high);
    f += d.cwiseProduct(q - system.q.tail(high)) / h;
    j = 0.5 * k_.bottomRightCorner(high, high);
    j.diagonal().array() += inertia + d.array() / h;
  };
  high_ = next_.tail(high);
  const NewtonOutcome outcome = newton_.solve(evaluate, options_, high_);
  next_.tail(high) = high_;
  // q' = q + h (p⁺ + p')/2
  system.p.tail(high) = 2.0 / h * (high_ - system.q.tail(high)) - system.p.tail(high);
  system.q = next_;
  report_newton(outcome, options_, report);
}

SolverRegistry::Entry ImexThesis::entry() {
  std::vector<ParameterSpec> parameters{
      positive_parameter("split", "", "1", 1e6, "coordinates with f < split/h are explicit")};
  for (ParameterSpec& spec : newton_parameters("20", "1e-6")) parameters.push_back(std::move(spec));
  return {
      "imex_thesis",
      "implicit-explicit, force components split by frequency as the thesis does it; can blow up",
      parameters,
      {"reduced"},
      [](const Parameters& values) {
        return std::make_unique<ImexThesis>(values.number("split"), newton_options(values));
      }};
}

}  // namespace pliant
