#include "pliant/solvers/iterations/chebyshev.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/columns.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {
namespace {

constexpr double kLargestRadius = 0.999999;
// A recurrence leaves 1/T_n(1/ρ) of every error component, the quick ones too, which plain Jacobi
// would have taken away. In the iterations that there are it has to promise at least this.
constexpr double kLeastReduction = 10.0;

}  // namespace

double ChebyshevSolver::largest_radius(const Relaxation& relaxation, double stiffness_ratio,
                                       int iterations, int delay) {
  const double bound = relaxation.spectral_radius(stiffness_ratio);
  const double worthwhile =
      SpectralRadius::that_leaves(1.0 / kLeastReduction, std::max(1, iterations - delay));
  return std::min({bound, worthwhile, kLargestRadius});
}

void ChebyshevSolver::prepare_iterations(const ProjectiveSystem& system) {
  relaxation_ = make_relaxation(product(), system.particles);
  radius_ = SpectralRadius(
      largest_radius(relaxation_, objective().stiffness_ratio(), iterations_, options_.delay));
  stale_ = is_estimated_ && step_ != prepared_step() ? estimate_ : -1.0;
  step_ = prepared_step();
  is_estimated_ = options_.rho > 0.0;
  estimate_ = options_.rho;
  is_damped_ = false;
  const double lambda = std::max(relaxation_.largest_eigenvalue, 1e-300);
  damped_ = std::min(1.0, 1.0 / (relaxation_.gamma * lambda)) * relaxation_.mobility;
}

void ChebyshevSolver::save_learned(StateArchive& numbers) const {
  numbers.write(is_damped_ ? 1.0 : 0.0);
  numbers.write(is_estimated_ ? 1.0 : 0.0);
  numbers.write(estimate_);
}

void ChebyshevSolver::load_learned(StateArchive& numbers) {
  is_damped_ = numbers.read() == 1.0;
  const bool is_estimated = numbers.read() == 1.0;
  const double estimate = numbers.read();
  // Where the step changed, what was learned with the other one is no estimate for this one.
  if (options_.rho > 0.0 || (is_estimated && estimate == stale_)) return;
  is_estimated_ = is_estimated;
  estimate_ = estimate;
}

double ChebyshevSolver::jacobi(ProjectiveSystem& system, StepReport& report) {
  parallel_copy(system.particles.x, before_);
  const bool shortened = is_damped_ && touched_ && !is_plain_;
  jacobi_update(system, shortened ? damped_ : relaxation_.mobility, report);
  return std::sqrt(parallel_sum(0, system.particles.size(), kColumnGrain, [&](int i) {
    const Eigen::Vector3d change = system.particles.x.col(i) - before_.col(i);
    return objective().diagonal()[i] * change.squaredNorm();
  }));
}

bool ChebyshevSolver::is_round_off(double change) const {
  return objective().is_round_off(change / relaxation_.gamma);
}

void ChebyshevSolver::estimate(ProjectiveSystem& system, StepReport& report) {
  const ScopedPhase phase(report, "spectral_radius");
  const Positions start = system.particles.x;
  double last = 0.0, ratio = 0.0;
  for (int k = 0; k < kPreSimulation; ++k) {
    compute_forces(system, report);
    // A body in free fall says nothing.
    if (k == 0 && objective().is_round_off(objective().norm(forces()))) return;
    const double change = jacobi(system, report);
    if (is_round_off(change)) break;
    if (last > 0.0) ratio = change / last;
    last = change;
  }
  estimate_ = ratio;
  is_estimated_ = true;
  system.particles.x = start;
  reset_constraints(system);
  estimate_radius(system);
  system.particles.x = start;
  reset_constraints(system);
}

void ChebyshevSolver::estimate_radius(ProjectiveSystem& system) {
  StepReport unseen;
  begin_recurrence();
  const bool was_damped = is_damped_;
  double first = 0.0;
  for (int k = 0; k < kEstimateIterations; ++k) {
    compute_forces(system, unseen);
    iterate(system, unseen);
    if (k == 0) first = last_change_;
    if (touched_ || is_round_off(last_change_) || last_change_ <= kEstimateChange * first) break;
  }
  is_damped_ = was_damped;
  estimate_ = radius_.value();
}

void ChebyshevSolver::restart(int plain_iterations) {
  plain_ = plain_iterations;
  accelerated_ = 0;
  omega_ = 1.0;
}

void ChebyshevSolver::begin_iterations(ProjectiveSystem& system, StepReport& report) {
  if (!is_estimated_ && iterations_ > options_.delay) estimate(system, report);
  begin_recurrence();
}

void ChebyshevSolver::begin_recurrence() {
  radius_.set(estimate_);
  restart(options_.delay);
  best_change_ = std::numeric_limits<double>::infinity();
  restarts_ = 0;
  touched_ = is_plain_ = false;
}

void ChebyshevSolver::follow_momentum(Positions& x) {
  if (!touched_) {
    momentum_ = 1.0;
    projected_ = x;
  }
  touched_ = true;
  // Uphill where (y − J(y)) · (J(y) − J(y₋)) > 0 in the norm of D: then momentum is lost.
  const double uphill = parallel_sum(0, static_cast<int>(x.cols()), kColumnGrain, [&](int i) {
    const Eigen::Vector3d displacement = x.col(i) - projected_.col(i);
    return objective().diagonal()[i] * (before_.col(i) - x.col(i)).dot(displacement);
  });
  if (uphill > 0.0) momentum_ = 1.0;
  const NesterovStep step = nesterov_step(momentum_);
  const double share = is_plain_ ? 0.0 : step.share;
  momentum_ = step.next;
  for_each_column(x, [&](int i) {
    const Eigen::Vector3d projected = x.col(i);
    x.col(i) += share * (projected - projected_.col(i));
    projected_.col(i) = projected;
  });
}

double ChebyshevSolver::next_omega() {
  if (plain_ > 0) {
    --plain_;
    return 1.0;
  }
  const double rho2 = radius_.value() * radius_.value();
  omega_ = chebyshev_factor(rho2, omega_, accelerated_ == 0);
  // The last plain iteration is the recurrence's first.
  if (accelerated_ == 0) first_change_ = earlier_change_;
  ++accelerated_;
  return omega_;
}

void ChebyshevSolver::keep_best(const Positions& x, const IterationChange& change) {
  if (!change.is_best(best_change_)) return;
  best_change_ = change.change;
  parallel_copy(x, best_);
}

bool ChebyshevSolver::iterate(ProjectiveSystem& system, StepReport& report) {
  Positions& x = system.particles.x;
  earlier_change_ = last_change_;
  last_change_ = jacobi(system, report);
  const IterationChange change = {last_change_, is_round_off(last_change_)};
  if (touched_ && !is_plain_ && change.has_grown_beyond(best_change_)) {
    is_plain_ = is_damped_;
    is_damped_ = true;
    report.warn("momentum_slowed: iterations with momentum grew; they take shorter steps now");
    x = best_;
    restart(1);
    touched_ = false;
    return true;
  }
  keep_best(x, change);
  if (meets_contact(system)) {
    // Contact holds exactly where its own projection came last.
    if (report.iterations < iterations_) follow_momentum(x);
    restart(2);
    return true;
  }
  touched_ = false;
  if (accelerated_ > 0 && change.has_grown_beyond(first_change_)) {
    radius_.lower();
    estimate_ = std::min(estimate_, radius_.value());
    report.warn(
        "spectral_radius_lowered: an accelerated iteration grew; the recurrence began anew");
    x = best_;
    ++restarts_;
    restart(1);
    previous_ = before_;
    return true;
  }
  if (options_.rho == 0.0 && change.lags(radius_, first_change_, accelerated_)) {
    radius_.raise(last_change_ / first_change_, accelerated_);
    restart(1);
    ++restarts_;
  }
  const double omega = next_omega();
  if (omega != 1.0) {
    for_each_column(
        x, [&](int i) { x.col(i) = omega * (x.col(i) - previous_.col(i)) + previous_.col(i); });
  }
  previous_.swap(before_);
  return true;
}

void ChebyshevSolver::go_on() {
  restart(1);
  best_change_ = std::numeric_limits<double>::infinity();
  touched_ = false;
}

void ChebyshevSolver::choose_end(ProjectiveSystem& system, StepReport& /*report*/) {
  if (best_change_ < last_change_) system.particles.x = best_;
}

void ChebyshevSolver::end_iterations(ProjectiveSystem&, StepReport& report) {
  report.add_metric("relaxation", relaxation_.gamma);
  report.add_metric("spectral_radius", radius_.value());
  report.add_metric("restarts", restarts_);
}

SolverRegistry::Entry chebyshev_entry() {
  std::vector<ParameterSpec> parameters = stop_rule_parameters("30");
  parameters.push_back(integer_parameter("delay", "5", 1, 1000,
                                         "plain Jacobi iterations before acceleration begins"));
  parameters.push_back(backend_parameter());
  parameters.push_back(number_parameter(
      "spectral_radius", "", "0", 0.0, kLargestRadius,
      "of a Jacobi iteration; 0 estimates it by a pre-simulation and refines it while it runs"));
  return {"chebyshev",
          "Chebyshev-accelerated Jacobi iterations; the choice for large bodies and many threads",
          parameters, projective_models(), [](const Parameters& given) {
            const StopRule rule = stop_rule(given);
            const int delay = given.integer("delay");
            const double rho = given.number("spectral_radius");
            return make_on_backend(
                given.text("backend"),
                std::make_unique<ChebyshevSolver>(rule, ChebyshevSolver::Options{delay, rho}),
                {"chebyshev", rule, true, rho, delay});
          }};
}

}  // namespace pliant
