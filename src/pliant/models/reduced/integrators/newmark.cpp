#include "pliant/models/reduced/integrators/newmark.h"

#include "pliant/models/reduced/integrators/midpoint.h"

namespace pliant {

void Newmark::prepare_step(const ReducedSystem& system, double) {
  damping_ = system.damping_rates();
  known_q_.resize(0);
}

void Newmark::advance(ReducedSystem& system, double h, StepReport& report) {
  if (known_q_.size() == 0 || known_q_ != system.q || known_p_ != system.p) {
    system.potential.evaluate(system.q, r_, space_);
    a_ = system.force - r_ - damping_.cwiseProduct(system.p);
  } else {
    a_ += system.force - known_force_;  // a force that jumps between two steps
  }
  // F(q') = 4/h² (q' - q - h p) - a + D (2/h (q' - q) - p) + R(q') - f
  const double inertia = 4.0 / (h * h);
  const auto evaluate = [&](const Eigen::VectorXd& q, Eigen::VectorXd& f, Eigen::MatrixXd& j) {
    system.potential.evaluate(q, r_, j, space_);
    f = inertia * (q - system.q - h * system.p) - a_ + r_ - system.force;
    f += damping_.cwiseProduct(2.0 / h * (q - system.q) - system.p);
    j.diagonal().array() += inertia + 2.0 / h * damping_.array();
  };
  next_ = system.q;
  report_newton(newton_.solve(evaluate, options_, next_), options_, report);
  a_ = inertia * (next_ - system.q - h * system.p) - a_;
  system.p = 2.0 / h * (next_ - system.q) - system.p;
  system.q = next_;
  known_q_ = system.q;
  known_p_ = system.p;
  known_force_ = system.force;
}

SolverRegistry::Entry Newmark::entry() {
  return {
      "newmark",
      "Newmark's method, beta 1/4 and gamma 1/2, by Newton's method; iterations 1 with tolerance "
      "0 is the real-time form",
      newton_parameters("20", "1e-8"),
      {"reduced"},
      [](const Parameters& parameters) {
        return std::make_unique<Newmark>(newton_options(parameters));
      }};
}

}  // namespace pliant
