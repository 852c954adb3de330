#include "pliant/solvers/iterations/direct.h"

#include "pliant/core/columns.h"

namespace pliant {
namespace {
// Corrections that shrink by no more in an iteration leave half of the error in ten of them.
constexpr double kCrawling = 0.933;

double dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return parallel_sum(0, static_cast<int>(a.cols()), kColumnGrain,
                      [&](int i) { return a.col(i).dot(b.col(i)); });
}
}  // namespace

void DirectSolver::prepare_iterations(const ProjectiveSystem& system) {
  FactoredSolver::prepare_iterations(system);
  cholesky_.factor(matrix());
  prepare_touched(cholesky_.nonzeros());
  for (Eigen::Matrix3Xd* m : {&start_, &last_x_, &last_correction_, &last_balance_}) {
    m->resize(3, system.particles.size());
  }
}

void DirectSolver::begin_iterations(ProjectiveSystem& system, StepReport& report) {
  FactoredSolver::begin_iterations(system, report);
  last_size_ = 0.0;
  extrapolated_ = 0;
}

bool DirectSolver::iterate(ProjectiveSystem& system, StepReport& report) {
  const auto p = [this](Eigen::Matrix3Xd& v) {
    multiply(matrix(), v, product_);
    v.swap(product_);
  };
  const auto p_inverse = [this](Eigen::Matrix3Xd& v) { cholesky_.solve(v); };
  if (finds_multipliers(system)) {
    if (goes_astray(system, report)) return false;
    correct(system, p_inverse, report);
    return true;
  }
  if (!begin_correction(system, report)) return true;
  {
    ScopedPhase phase(report, "global");
    equality_constrained().solve(rows(), system.particles, p, p_inverse, correction());
  }
  move(system, report);
  end_correction(system, report);
  return true;
}

void DirectSolver::move(ProjectiveSystem& system, StepReport& report) {
  Positions& x = system.particles.x;
  parallel_copy(x, start_);
  const double size = is_unconstrained() ? dot(correction(), balance()) : 0.0;
  const bool crawls = last_size_ > 0.0 && size > kCrawling * kCrawling * last_size_ &&
                      !objective().is_round_off(objective().norm(balance()));
  if (!crawls || !extrapolate(system)) {
    if (system.constraints.empty()) {
      for_each_column(x, [&](int i) { x.col(i) = start_.col(i) + correction().col(i); });
    } else {
      // What constraints hold is linearised: the full step need not lower the objective any more.
      ScopedPhase phase(report, "line_search");
      search(system, start_);
    }
  }
  last_size_ = size;
  if (size == 0.0) return;
  parallel_copy(start_, last_x_);
  parallel_copy(correction(), last_correction_);
  parallel_copy(balance(), last_balance_);
}

bool DirectSolver::extrapolate(ProjectiveSystem& system) {
  Positions& x = system.particles.x;
  const Positions& d = correction();
  const Forces& r = balance();
  // γ = (d, d − d') / |d − d'|², with A d = r in the products.
  const int n = static_cast<int>(x.cols());
  const double change = parallel_sum(0, n, kColumnGrain, [&](int i) {
    return (d.col(i) - last_correction_.col(i)).dot(r.col(i) - last_balance_.col(i));
  });
  const double along = parallel_sum(
      0, n, kColumnGrain, [&](int i) { return d.col(i).dot(r.col(i) - last_balance_.col(i)); });
  if (!(change > 0.0)) return false;
  const double gamma = along / change, before = objective().value(system);
  for_each_column(x, [&](int i) {
    const Eigen::Vector3d here = start_.col(i) + d.col(i);
    x.col(i) = here - gamma * (here - last_x_.col(i) - last_correction_.col(i));
  });
  if (!(objective().value(system) <= before)) return false;
  ++extrapolated_;
  return true;
}

void DirectSolver::end_iterations(ProjectiveSystem& system, StepReport& report) {
  FactoredSolver::end_iterations(system, report);
  report.add_metric("factor_nonzeros", static_cast<double>(cholesky_.nonzeros()));
  report.add_metric("extrapolated", extrapolated_);
}

SolverRegistry::Entry direct_entry() {
  return {
      "direct",
      "projective dynamics with a Cholesky factor made once; exact global steps, stiff and fine "
      "bodies; a new factor when masses, pins or the time step change",
      stop_rule_parameters("10"), deformable_models(), [](const Parameters& parameters) {
        return std::make_unique<DirectSolver>(stop_rule(parameters));
      }};
}

}  // namespace pliant
