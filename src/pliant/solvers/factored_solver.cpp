#include "pliant/solvers/factored_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {
namespace {
constexpr double kArmijo = 1e-4;
constexpr int kMaxHalvings = 30;
constexpr int kMaxSweeps = 64;
// Differences of the objective below this share of it are round-off.
constexpr double kRoundOff = 1e-14;
// Conditions that come to be met may raise the objective; more than this many times, the correction
// went astray.
constexpr double kMuchWorse = 3.0;
constexpr int kSweepsInstead = 8;
}  // namespace

void FactoredSolver::prepare_iterations(const ProjectiveSystem& system) {
  relaxation_ = make_relaxation(matrix(), system.particles);
}

void FactoredSolver::begin_iterations(ProjectiveSystem& system, StepReport& report) {
  sweeps_ = 1;
  is_on_trial_ = false;
  taken_back_ = 0;
  smallest_balance_ = std::numeric_limits<double>::infinity();
  if (system.couplings.empty()) return;
  // What couplings hold is known once they were asked.
  compute_forces(system, report);
  jacobi_update(system, relaxation_.mobility, report);
}

void FactoredSolver::ask_couplings(const ProjectiveSystem& system) {
  rows_.clear();
  held_.setZero(3, forces().cols());
  for (Coupling* coupling : system.couplings) {
    coupling->add_rows(system.particles.x, rows_);
    coupling->add_forces(held_);
  }
}

bool FactoredSolver::is_much_worse(const ProjectiveSystem& system) const {
  return is_on_trial_ && objective().value(system) > kMuchWorse * objective_before_;
}

void FactoredSolver::take_back(ProjectiveSystem& system, StepReport& report) {
  ++taken_back_;
  is_on_trial_ = false;
  system.particles.x = before_;
  sweep(system, kSweepsInstead, report);
}

bool FactoredSolver::begin_correction(ProjectiveSystem& system, StepReport& report) {
  ask_couplings(system);
  if (!system.couplings.empty()) {
    if (is_much_worse(system)) {
      take_back(system, report);
      return false;
    }
    is_on_trial_ = true;
    before_ = system.particles.x;
    objective_before_ = objective().value(system);
  }
  balance_ = forces() + held_;
  for (int i = 0; i < system.particles.size(); ++i) {
    if (system.particles.is_fixed(i)) balance_.col(i).setZero();
  }
  correction_ = balance_;
  return true;
}

void FactoredSolver::end_correction(ProjectiveSystem& system, StepReport& report) {
  if (system.couplings.empty()) return;
  const double size = objective().norm(balance_);
  if (size >= smallest_balance_) sweeps_ = std::min(2 * sweeps_, kMaxSweeps);
  smallest_balance_ = std::min(smallest_balance_, size);
  sweep(system, sweeps_, report);
}

void FactoredSolver::sweep(ProjectiveSystem& system, int times, StepReport& report) {
  for (int k = 0; k < times; ++k) {
    compute_forces(system, report);
    jacobi_update(system, relaxation_.mobility, report);
  }
}

void FactoredSolver::judge_last_iteration(ProjectiveSystem& system, StepReport& report) {
  if (is_much_worse(system)) take_back(system, report);
}

void FactoredSolver::end_iterations(ProjectiveSystem&, StepReport& report) {
  report.add_figure("coupled_iterations", coupled_.iterations());
  report.add_figure("corrections_taken_back", taken_back_);
}

double FactoredSolver::search(ProjectiveSystem& system, const Positions& start) {
  Positions& x = system.particles.x;
  if (!rows_.are_met()) {
    // Closing contacts may well raise the objective.
    x = start + correction_;
    return 1.0;
  }
  // φ without the constant forces of the couplings is not what the correction lowers.
  const double work = held_.cwiseProduct(correction_).sum();
  const double slope = balance_.cwiseProduct(correction_).sum();
  const double before = objective().value(system);
  const double slack = kRoundOff * std::abs(before);
  double step = 1.0;
  for (int k = 0; k < kMaxHalvings; ++k, step *= 0.5) {
    x = start + step * correction_;
    const double change = objective().value(system) - before - step * work;
    if (change <= -kArmijo * step * slope + slack) return step;
  }
  x = start;
  return 0.0;
}

}  // namespace pliant
