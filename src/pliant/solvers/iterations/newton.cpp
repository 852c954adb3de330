#include "pliant/solvers/iterations/newton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/solvers/checks/residual_share.h"
#include "pliant/solvers/components/rigid_clusters.h"
#include "pliant/solvers/linear/matrix_rows.h"

namespace pliant {
namespace {

// Where nobody asks for another one.
constexpr double kTolerance = 1e-10;
// Of a particle's 1/D, for the compliance with which constraints stand in the Hessian. Multipliers
// make up for it, the sooner the smaller it is.
constexpr double kConstraintCompliance = 0.4;
// C of contacts of rigid bodies, as a share of what all other solvers take and residuals count: a
// matrix that holds all of them lets each find its force beside the others.
constexpr double kRigidCompliance = 0.03;
// Decrements, which are squares, that shrink to more than so many times the linear tolerance from
// one iteration to the next ask for another Hessian.
constexpr double kShrinks = 4.0;
// Corrections under rows, each of which finds the multipliers that the one before missed; and what
// may be missed.
constexpr int kPasses = 8;
constexpr double kMissed = 1e-3;
// Of a step that is taken again since it gained energy: iterations until a correction is that small
// a share of the largest, by what they promise.
constexpr int kGuardIterations = 60;
constexpr double kGuardShare = 1e-12, kGuardTolerance = 1e-6;
// And until its linear equations took so many times the iterations that the step had, or the least
// number of them: what is hardly solvable is held back sooner than it converges.
constexpr double kGuardWork = 50.0, kLeastGuardWork = 10'000.0;
// Iterations without the exact Hessian after it failed: twice as many each time, this many times.
constexpr int kMostWait = 3;
// Of decrements that shrink to more than so much, so many times in a row, what is slow are
// multipliers of rows that nearly depend on each other: with a share of the compliance they find
// each other faster. So many times in a step, with linear equations that are solved so exactly.
constexpr double kSlow = 0.3, kStiffer = 0.1, kExactly = 1e-3, kNearEnd = 1e-6;
constexpr int kMostSlow = 3, kMostStiffened = 3;
// Where rounds of contact do not come into balance, C along normals is a share of what points
// answer there, and so much of that after so many slow corrections in a row.
constexpr double kHarder = 0.1;
constexpr int kMostSlowSoft = 2;
// After a correction that lowers nothing, the next one is solved so many times as exactly, and the
// one after that again, so many times.
constexpr double kSharper = 0.1;
constexpr int kMostRejected = 3;

}  // namespace

void NewtonSolver::prepare_iterations(const ProjectiveSystem& system) {
  FactoredSolver::prepare_iterations(system);
  hessian_.prepare();
  constrained().set_cautious(true);
  mobility_of_constraints_ = free_mobility(objective().diagonal(), system.particles);
  let_rigid_bodies_move(system, objective().inertia(), mobility_of_constraints_);
  mobility_of_constraints_ *= kConstraintCompliance;
  compliance_ = mobility_of_constraints_;
}

void NewtonSolver::begin_iterations(ProjectiveSystem& system, StepReport& report) {
  FactoredSolver::begin_iterations(system, report);
  hessian_.begin_step(is_tight(), true);
  definiteness_ = is_tight() ? Definiteness::kExact : Definiteness::kProjected;
  is_kept_ = is_cut_ = is_taken_again_ = false;
  last_decrement_ = 0.0;
  exact_wait_ = exact_failures_ = 0;
  compliance_ = mobility_of_constraints_;
  slow_ = slow_soft_ = stiffened_ = 0;
  softness_ = 0.0;
  hessians_ = projected_ = gradients_ = rejected_ = 0;
  first_ = system.particles.x;
}

void NewtonSolver::go_on() {
  FactoredSolver::go_on();
  rejected_ = 0;
  is_kept_ = false;
  last_decrement_ = 0.0;
}

void NewtonSolver::assemble(const ProjectiveSystem& system) {
  hessian_.assemble(system, system.particles.x, objective().inertia(), definiteness_);
  is_kept_ = true;
  age_ = 0;
  ++hessians_;
  if (definiteness_ == Definiteness::kProjected) ++projected_;
}

template <class Solve>
bool NewtonSolver::solve_definite(const ProjectiveSystem& system, const Solve& solve) {
  const bool was_kept = is_kept_;
  if (!is_kept_) assemble(system);
  continues_ = false;
  const bool is_exact = definiteness_ == Definiteness::kExact;
  if (solve() && (!is_exact || promise() >= 0.0)) return true;
  if (!is_exact && !was_kept) return false;
  if (is_exact) exact_failed();
  definiteness_ = Definiteness::kProjected;
  assemble(system);
  continues_ = false;
  return solve();
}

bool NewtonSolver::give_up(StepReport& report) {
  report.warn(
      "not_solved: the equations of a Newton iteration have no finite solution, and the step ends "
      "where it is: take a smaller time step, or another solver");
  return false;
}

void NewtonSolver::exact_failed() { exact_wait_ = 2 << std::min(exact_failures_++, kMostWait); }

bool NewtonSolver::solve(Eigen::Matrix3Xd& v) {
  const double tolerance = linear_tolerance_ * std::pow(kSharper, rejected_);
  const bool is_solved = hessian_.solve(tolerance, v, continues_);
  continues_ = true;
  gradients_ += hessian_.iterations();
  return is_solved;
}

bool NewtonSolver::solve_with(const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left) {
  hessian_.rows().clear();
  append_springs(rows, compliance_, hessian_.rows());
  hessian_.use_rows();
  if (!solve(v)) return false;
  left = hessian_.residual();
  return true;
}

bool NewtonSolver::correct_under_constraints(ProjectiveSystem& system) {
  constrained().collect(system);
  is_under_constraints_ = true;
  return solve_definite(system, [&] {
    const bool is_soft = softness_ > 0.0;
    if (is_soft) hessian_.find_own_answers(objective().inertia(), own_answers_);
    constrained().soften(is_soft ? &own_answers_ : nullptr, softness_);
    constrained().stiffen_rigid(kRigidCompliance);
    correction() = forces();
    const bool is_solved = constrained().solve(
        system, compliance_,
        [this](const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left) {
          return solve_with(rows, v, left);
        },
        correction());
    // Residuals count gaps as ever.
    constrained().soften(nullptr, 0.0);
    constrained().stiffen_rigid(1.0);
    return is_solved;
  });
}

bool NewtonSolver::correct_under_rows(ProjectiveSystem& system) {
  is_under_constraints_ = false;
  const ConstraintRows& all = rows();
  HeldRows& springs = hessian_.rows();
  springs.clear();
  append_springs(all, compliance_, springs);
  const auto factor_and_solve = [&] {
    // H d + Jᵀ μ = r, J d − C μ = c, proximally: with E added to C, μ is found but for what is
    // missed of c by E μ, which is what the next pass is for.
    hessian_.use_rows();
    correction().setZero(3, balance().cols());
    part_ = balance();
    missed_.resize(all.size());
    for (int r = 0; r < all.size(); ++r) missed_[r] = all.target(r);
    double first = 0.0;
    for (int pass = 0; pass < kPasses; ++pass) {
      springs.add_force(missed_, part_);
      if (!solve(part_)) return false;
      correction() += part_;
      if (all.size() == 0) return true;
      double changed = 0.0;
      for (int r = 0; r < all.size(); ++r) {
        const double stiffness = springs.stiffness(r);
        if (stiffness == 0.0) {
          missed_[r] = 0.0;
          continue;
        }
        // E μ changed by so much.
        missed_[r] = (1.0 - stiffness * all.compliance(r)) * (missed_[r] - springs.along(r, part_));
        changed += stiffness * missed_[r] * missed_[r];
      }
      if (pass == 0) first = changed;
      if (changed <= kMissed * kMissed * first) return true;
      part_.setZero();
    }
    return true;
  };
  return solve_definite(system, factor_and_solve);
}

double NewtonSolver::promise() const {
  if (is_under_constraints_) {
    return (forces() + constrained().forces()).cwiseProduct(correction()).sum();
  }
  return balance().cwiseProduct(correction()).sum();
}

void NewtonSolver::reject(ProjectiveSystem& system) {
  constrained().take_back(system);
  is_kept_ = false;
  rejected_ = std::min(rejected_ + 1, kMostRejected);
}

bool NewtonSolver::is_contradicted() {
  const auto& all = constrained().constraints().all;
  return std::any_of(all.begin(), all.end(),
                     [](const PointConstraint& constraint) { return constraint.is_contradicted; });
}

void NewtonSolver::follow_slow(double decrement, double step) {
  if (last_decrement_ == 0.0) first_decrement_ = decrement;
  // Only near the end, of equations that are solved so exactly that they are not what is slow. What
  // constraints contradict each other in stays, and their forces would grow the faster.
  const bool is_slow = linear_tolerance_ <= kExactly && step == 1.0 &&
                       decrement > kSlow * last_decrement_ &&
                       decrement < kNearEnd * first_decrement_;
  slow_ = is_slow ? slow_ + 1 : 0;
  if (slow_ < kMostSlow || stiffened_ == kMostStiffened || is_contradicted()) return;
  slow_ = 0;
  ++stiffened_;
  compliance_ *= kStiffer;
}

void NewtonSolver::follow_softened(double decrement, double step) {
  if (softness_ == 0.0) {
    if (is_under_constraints_ && !constrained().is_balanced()) softness_ = kConstraintCompliance;
    return;
  }
  const bool is_slow = step == 1.0 && last_decrement_ > 0.0 && decrement > kSlow * last_decrement_;
  slow_soft_ = is_slow ? slow_soft_ + 1 : 0;
  if (slow_soft_ < kMostSlowSoft) return;
  slow_soft_ = 0;
  softness_ *= kHarder;
}

void NewtonSolver::judge(double decrement, double step) {
  if (exact_wait_ > 0) --exact_wait_;
  is_stuck_ = is_search_blind() && last_decrement_ > 0.0 && decrement >= 0.5 * last_decrement_;
  follow_slow(decrement, step);
  follow_softened(decrement, step);
  const bool shrinks = !is_tight() && (last_decrement_ == 0.0 ||
                                       decrement <= kShrinks * linear_tolerance_ * last_decrement_);
  last_decrement_ = decrement;
  ++age_;
  if (step == 1.0 && shrinks) return;
  is_kept_ = false;
  // The exact one is worth a trial where a fresh one that was fit for full steps is not enough.
  const bool is_slow = step == 1.0 && age_ <= 2;
  definiteness_ =
      is_tight() || (is_slow && exact_wait_ == 0) ? Definiteness::kExact : Definiteness::kProjected;
}

bool NewtonSolver::iterate(ProjectiveSystem& system, StepReport& report) {
  Positions& x = system.particles.x;
  if (finds_multipliers(system)) {
    {
      ScopedPhase phase(report, "global");
      if (!correct_under_constraints(system)) return give_up(report);
      const double share = constrained().reached_share(correction());
      is_cut_ = share < 1.0;
      if (is_cut_) correction() *= share;
    }
    ScopedPhase phase(report, "line_search");
    const double step = search_along(system);
    judge(promise(), step);
    if (step > 0.0) {
      rejected_ = 0;
    } else {
      reject(system);
    }
    return true;
  }
  if (!begin_correction(system, report)) return true;
  start_ = x;
  {
    ScopedPhase phase(report, "global");
    if (!correct_under_rows(system)) return give_up(report);
  }
  double step;
  {
    ScopedPhase phase(report, "line_search");
    step = search(system, start_);
    judge(promise(), step);
  }
  end_correction(system, report);
  // What constraints hold is not found yet where nothing moves any more.
  if (!system.constraints.empty()) return true;
  const double reach = std::numeric_limits<double>::epsilon() * x.cwiseAbs().maxCoeff();
  return (x - start_).cwiseAbs().maxCoeff() > reach && step > 0.0 && !is_stuck_;
}

void NewtonSolver::take_again(ProjectiveSystem& system, StepReport& report) {
  system.particles.x = first_;
  const double asked = std::exchange(linear_tolerance_, kGuardTolerance);
  const double most = std::max(kGuardWork * static_cast<double>(gradients_), kLeastGuardWork);
  begin_iterations(system, report);
  is_taken_again_ = true;
  double largest = 0.0;
  for (int k = 0; k < kGuardIterations; ++k) {
    compute_forces(system, report);
    ++report.iterations;
    if (!iterate(system, report)) break;
    largest = std::max(largest, std::abs(last_decrement_));
    if (std::abs(last_decrement_) <= kGuardShare * largest || gradients_ > most) break;
  }
  linear_tolerance_ = asked;
}

void NewtonSolver::end_iterations(ProjectiveSystem& system, StepReport& report) {
  report.add_metric("taken_again", is_taken_again_ ? 1.0 : 0.0);
  is_unsolved_ = rule().tolerance > 0.0 && report.ended_by != EndedBy::kTolerance;
  FactoredSolver::end_iterations(system, report);
  if (is_cut_) {
    report.warn(
        "air_limited: the air would move vertices further than a quarter of the mesh width in the "
        "last iteration; its pressure is not converged: take a smaller time step or more "
        "iterations");
  }
  report.add_metric("hessians", hessians_);
  report.add_metric("projected_hessians", projected_);
  report.add_metric("linear_iterations", gradients_);
}

double NewtonSolver::residual_share(const ProjectiveSystem& system) const {
  return share_of_free_solids(system, objective().diagonal(), objective().inertia());
}

SolverRegistry::Entry newton_entry() {
  std::vector<ParameterSpec> parameters = stop_rule_parameters("200");
  for (ParameterSpec& parameter : parameters) {
    if (parameter.name == "tolerance") parameter.default_value = fmt::format("{}", kTolerance);
    if (parameter.name == "error") {
      parameter.meaning =
          "adapt 'tolerance' from step to step so that the estimated distance from where the body "
          "should be stays below this share of its displacement; a 'tolerance' beside it is the "
          "largest; 0 keeps it";
    }
  }
  parameters.push_back(number_parameter(
      "linear_tolerance", "", "1e-12", 1e-14, 0.1,
      "share of an iteration's correction that its linear equations may leave to the next one"));
  return {
      "newton",
      "Newton's method with line search and contact in its linear equations: to convergence the "
      "reference; with one to three iterations and a 'linear_tolerance' of 0.03 fast, for bodies "
      "up to some 1e6 Pa that roll and hit",
      parameters, projective_models(), [](const Parameters& given) {
        StopRule rule = stop_rule(given);
        // Nobody gave the largest one.
        if (rule.error > 0.0 && rule.tolerance == kTolerance) rule.tolerance = 0.0;
        return std::make_unique<NewtonSolver>(rule, given.number("linear_tolerance"));
      }};
}

}  // namespace pliant
