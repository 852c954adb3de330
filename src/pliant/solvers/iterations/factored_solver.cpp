#include "pliant/solvers/iterations/factored_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/system/responding_system.h"
#include "pliant/solvers/components/rigid_clusters.h"

namespace pliant {
namespace {
constexpr int kMaxSweeps = 64;
// Conditions that come to be met may raise the objective; more than this many times, the correction
// went astray.
constexpr double kMuchWorse = 3.0;
constexpr int kSweepsInstead = 8;
// Of a particle's diagonal entry to its inertia: A⁻¹ between particles that contact touches holds
// what bodies as a whole answer too, and loses as many digits of what deforms. Beyond this, a stiff
// ball rolled up to a tenth too far where conjugate gradients saw it.
constexpr double kStiff = 5e5;
}  // namespace

void FactoredSolver::prepare_iterations(const ProjectiveSystem& system) {
  relaxation_ = make_relaxation(product(), system.particles);
  for (const auto& responder : system.responders) {
    for (int i = responder.begin; i < responder.end; ++i) {
      if (system.particles.is_fixed(i)) continue;
      relaxation_.mobility[i] = responder.system->answer(i - responder.begin);
    }
  }
  contact_mobility_ = own_answers_ = relaxation_.mobility;
  let_rigid_bodies_move(system, objective().inertia(), contact_mobility_);
  is_own_.assign(static_cast<std::size_t>(own_answers_.size()), false);
  for (const auto& responder : system.responders) {
    std::fill(is_own_.begin() + responder.begin, is_own_.begin() + responder.end, true);
  }
  touched_.resize(system.responders.size());
  on_touched_.resize(system.responders.size());
  const Components components = find_components(system);
  rigid_modes_.prepare(components, objective().inertia());
  rigid_bend_.prepare(system, components);
}

void FactoredSolver::begin_iterations(ProjectiveSystem& system, StepReport& report) {
  sweeps_ = 1;
  is_on_trial_ = false;
  taken_back_ = 0;
  best_.forget();
  smallest_balance_ = std::numeric_limits<double>::infinity();
  finds_multipliers_ = may_find_multipliers(system);
  if (finds_multipliers_) {
    constrained_.begin_step();
    for (Constraint* constraint : system.constraints) constraint->warm_start();
    bend_rigid_bodies(system);
    return;
  }
  // Without iterations a step ends with the prediction and final projections, which keep momentum.
  if (system.constraints.empty() || rule().iterations == 0) return;
  // What constraints hold is known once they were asked.
  compute_forces(system, report);
  jacobi_update(system, relaxation_.mobility, report);
}

void FactoredSolver::bend_rigid_bodies(ProjectiveSystem& system) {
  if (!rigid_bend_.is_used()) return;
  system.particles.x += rigid_bend_.find(constrained_.collect(system), system.particles.x);
}

void FactoredSolver::go_on() {
  is_on_trial_ = false;
  best_.forget();
  smallest_balance_ = std::numeric_limits<double>::infinity();
}

void FactoredSolver::ask_constraints(const ProjectiveSystem& system) {
  rows_.clear();
  held_.setZero(3, forces().cols());
  for (Constraint* constraint : system.constraints) {
    constraint->add_rows(system.particles.x, rows_);
    constraint->add_forces(held_);
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

bool FactoredSolver::finds_multipliers(const ProjectiveSystem& system) const {
  const auto acts = [](const Constraint* constraint) { return !constraint->is_idle(); };
  return finds_multipliers_ &&
         std::any_of(system.constraints.begin(), system.constraints.end(), acts);
}

void FactoredSolver::find_squared_violations(ProjectiveSystem& system,
                                             Eigen::VectorXd& violations) {
  if (!finds_multipliers(system)) {
    violations.resize(0);
    return;
  }
  constrained_.find_squared_violations(system, contact_mobility_, violations);
}

void FactoredSolver::update_own_answers(const PointConstraints& constraints) {
  asked_.clear();
  for (const PointConstraints::Entry& entry : constraints.entries) {
    const auto i = static_cast<std::size_t>(entry.particle);
    if (is_own_[i] || own_answers_[entry.particle] == 0.0) continue;
    is_own_[i] = true;
    asked_.push_back(entry.particle);
  }
  const std::vector<double>& own = touched_inverse_.own(asked_);
  for (std::size_t k = 0; k < asked_.size(); ++k) {
    const int i = asked_[k];
    own_answers_[i] = std::max(own_answers_[i], own[k] - rigid_modes_.translation(i));
  }
}

void FactoredSolver::prepare_touched(Eigen::Index nonzeros) {
  touched_inverse_.prepare(own_answers_.size(), nonzeros,
                           [this](Eigen::Matrix3Xd& v) { solve_matrix(v); });
}

void FactoredSolver::list_touched(const ProjectiveSystem& system,
                                  const PointConstraints& constraints) {
  for (std::size_t k = 0; k < system.responders.size(); ++k) {
    const auto& responder = system.responders[k];
    is_touched_.assign(static_cast<std::size_t>(responder.size()), false);
    touched_[k].clear();
    for (const PointConstraints::Entry& entry : constraints.entries) {
      const int own = entry.particle - responder.begin;
      if (!responder.has(entry.particle) || is_touched_[static_cast<std::size_t>(own)]) continue;
      is_touched_[static_cast<std::size_t>(own)] = true;
      touched_[k].push_back(own);
    }
  }
}

void FactoredSolver::keep_forces(const ProjectiveSystem& system, const Forces& v) {
  for (std::size_t k = 0; k < system.responders.size(); ++k) {
    on_touched_[k].resize(3, static_cast<Eigen::Index>(touched_[k].size()));
    for (std::size_t t = 0; t < touched_[k].size(); ++t) {
      on_touched_[k].col(static_cast<Eigen::Index>(t)) =
          v.col(system.responders[k].begin + touched_[k][t]);
    }
  }
}

void FactoredSolver::respond(const ProjectiveSystem& system, Positions& v) {
  for (std::size_t k = 0; k < system.responders.size(); ++k) {
    const auto& responder = system.responders[k];
    auto own = v.middleCols(responder.begin, responder.size());
    for (std::size_t t = 0; t < touched_[k].size(); ++t) {
      own.col(touched_[k][t]) = on_touched_[k].col(static_cast<Eigen::Index>(t));
    }
    responder.system->respond(touched_[k], own);
  }
}

double FactoredSolver::correct(ProjectiveSystem& system, const LinearOperator& p_inverse,
                               StepReport& report) {
  Positions& x = system.particles.x;
  correction_ = forces();
  {
    ScopedPhase phase(report, "global");
    rigid_modes_.update(x);
    const PointConstraints& constraints = constrained_.collect(system);
    list_touched(system, constraints);
    update_own_answers(constraints);
    const auto with_rigid_modes = [&](Eigen::Matrix3Xd& v) {
      // What answers together stands for loose particles in the matrix.
      keep_forces(system, v);
      rigid_modes_.take_out(v);
      p_inverse(v);
      rigid_modes_.put_in(v);
      respond(system, v);
    };
    touched_inverse_.begin_correction(rigid_modes_, pairs());
    // A⁻¹ does not hold the answers of bodies that have coordinates of their own.
    const bool may_restrict = system.responders.empty() && objective().stiffness_ratio() < kStiff;
    constrained_.solve(system, relaxation_.mobility, own_answers_, rigid_modes_,
                       {with_rigid_modes, may_restrict ? &touched_inverse_ : nullptr}, correction_);
  }
  ScopedPhase phase(report, "line_search");
  return search_along(system);
}

bool FactoredSolver::goes_astray(ProjectiveSystem& system, StepReport& report) {
  // With others that take their turns, an iterate is not this solver's alone.
  if (!system.moved_by_others.empty()) return false;
  const bool is_measured = rule().tolerance > 0.0 || report.iterations <= 2;
  const double residual = is_measured ? report.residual : relative_residual(system, report);
  const double left = objective().last_residual();
  if (!best_.is_far_better_than(left)) {
    best_.offer(left, residual, system.particles.x, constrained_.constraints());
    return false;
  }
  return_to_best(system, report);
  compute_forces(system, report);
  return true;
}

void FactoredSolver::return_to_best(ProjectiveSystem& system, StepReport& report) {
  report.warn(
      "iterations_astray: iterations in contact went away from balance, and the step goes on from "
      "the best of them or ends there: take newton or a smaller time step");
  ++taken_back_;
  best_.restore(system.particles.x, constrained_.constraints());
  constrained_.give_multipliers(system);
}

void FactoredSolver::choose_end(ProjectiveSystem& system, StepReport& report) {
  const bool has_converged = report.ended_by == EndedBy::kTolerance;
  if (has_converged || !finds_multipliers(system) || !system.moved_by_others.empty()) return;
  compute_forces(system, report);
  relative_residual(system, report);
  if (!best_.is_far_better_than(objective().last_residual())) return;
  return_to_best(system, report);
  report.residual = best_.residual();
}

double FactoredSolver::search_along(ProjectiveSystem& system) {
  before_ = system.particles.x;
  const double work = constrained_.forces().cwiseProduct(correction_).sum();
  const double slope = forces().cwiseProduct(correction_).sum() + work;
  return search_lower(system, before_, objective().value(system), slope,
                      [&](double step) { return -step * work; });
}

bool FactoredSolver::begin_correction(ProjectiveSystem& system, StepReport& report) {
  ask_constraints(system);
  if (!system.constraints.empty()) {
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
  if (system.constraints.empty()) return;
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
  if (!finds_multipliers_ && is_much_worse(system)) take_back(system, report);
}

void FactoredSolver::end_iterations(ProjectiveSystem&, StepReport& report) {
  report.add_metric("inner_iterations", finds_multipliers_ ? constrained_.iterations()
                                                           : equality_constrained_.iterations());
  report.add_metric("corrections_taken_back", taken_back_);
}

double FactoredSolver::search(ProjectiveSystem& system, const Positions& start) {
  if (!rows_.are_met()) {
    // Closing contacts may well raise the objective.
    system.particles.x = start + correction_;
    return 1.0;
  }
  // φ without the constant forces of the constraints is not what the correction lowers.
  const double work = held_.cwiseProduct(correction_).sum();
  const double slope = balance_.cwiseProduct(correction_).sum();
  return search_lower(system, start, objective().value(system), slope,
                      [&](double step) { return -step * work; });
}

}  // namespace pliant
