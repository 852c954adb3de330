#include "pliant/solvers/lockstep.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pliant/core/body.h"
#include "pliant/core/columns.h"
#include "pliant/math/error.h"
#include "pliant/solvers/factored_solver.h"

namespace pliant {
namespace {

const char* const kAllowed =
    "bodies in contact take 'xpbd' and one setting of 'direct', 'lbfgs' or 'newton', or the same "
    "solver all of them";

}  // namespace

LockstepSolver::Parts LockstepSolver::parts_of(const Group& group) {
  Parts parts = {nullptr, {}, 1, {}};
  const Body* corrected = nullptr;
  int sweeps = 0;
  for (Body* body : group.bodies()) {
    Solver& solver = body->solver->on_cpu();
    const Solver::InLockstep part = solver.in_lockstep();
    auto* xpbd = part == Solver::InLockstep::kSweeps ? static_cast<XpbdSolver*>(&solver) : nullptr;
    parts.members.push_back({body->model->system().as_projective(), xpbd});
    if (xpbd != nullptr) {
      sweeps = std::max(sweeps, xpbd->rule().iterations);
      continue;
    }
    if (part != Solver::InLockstep::kCorrections) {
      throw InputError(
          fmt::format("solver '{}' of body '{}' cannot go together with those of the "
                      "bodies that it may touch: {}",
                      solver.name(), body->name, kAllowed));
    }
    auto* corrections = static_cast<FactoredSolver*>(&solver);
    if (corrected != nullptr && parts.corrections != corrections) {
      throw InputError(
          fmt::format("the solvers of bodies '{}' and '{}', which may touch, differ: {}",
                      corrected->name, body->name, kAllowed));
    }
    corrected = body;
    parts.corrections = corrections;
  }
  if (parts.corrections == nullptr) {
    throw InputError(
        fmt::format("bodies that may touch have 'xpbd' with other parameters: {}", kAllowed));
  }
  parts.rule = parts.corrections->ProjectiveSolver::rule();
  const int corrections = std::max(1, parts.rule.iterations);
  parts.sweeps = std::max(1, (sweeps + corrections - 1) / corrections);
  return parts;
}

LockstepSolver::LockstepSolver(const Group& group) : LockstepSolver(parts_of(group), group) {}

LockstepSolver::LockstepSolver(Parts parts, const Group& group)
    : ProjectiveSolver(parts.rule), parts_(std::move(parts)), group_(group) {}

void LockstepSolver::prepare_system(const ProjectiveSystem& system, double dt) {
  const JointSystem& all = *group_.joint();
  std::vector<ProjectiveSystem*> systems;
  std::vector<bool> bare;
  swept_elements_.clear();
  swept_constraints_.clear();
  for (std::size_t m = 0; m < parts_.members.size(); ++m) {
    const Member& member = parts_.members[m];
    systems.push_back(member.system);
    bare.push_back(member.sweeps != nullptr);
    if (member.sweeps == nullptr) continue;
    for (ElementSet* set : all.elements_of(static_cast<int>(m))) swept_elements_.push_back(set);
    for (Coupling* own : all.constraints_of(static_cast<int>(m))) {
      swept_constraints_.push_back(own);
    }
  }
  corrected_ = std::make_unique<JointSystem>(systems, bare);
  for (Coupling* constraint : all.between()) corrected_->add_constraint(constraint);
  parts_.corrections->prepare(*corrected_, dt);
  objective_.prepare(system, dt);
  answers_ = dt * dt * system.particles.inverse_mass;
}

void LockstepSolver::begin(ProjectiveSystem& system, StepReport& report) {
  reset_couplings(system);
  for (ElementSet* set : swept_elements_) set->reset_multipliers();
  // What the corrections see begins like all others.
  corrected_->particles = system.particles;
  corrected_->external_forces = system.external_forces;
  parts_.corrections->objective_.begin_step(*corrected_);
  parts_.corrections->begin_iterations(*corrected_, report);
}

void LockstepSolver::sweep(ProjectiveSystem& system, double dt, StepReport& report) {
  Positions& x = system.particles.x;
  for (int k = 0; k < parts_.sweeps; ++k) {
    for (ElementSet* set : swept_elements_) {
      ScopedPhase phase(report, set->name());
      set->relax(system.particles.inverse_mass, dt, x);
    }
    for (Coupling* constraint : swept_constraints_) {
      ScopedPhase phase(report, constraint->name());
      constraint->relax(answers_, x);
    }
  }
}

void LockstepSolver::find_contact_forces(const ProjectiveSystem& system) {
  contact_.setZero(3, system.particles.size());
  for (const Coupling* constraint : group_.joint()->between()) constraint->add_forces(contact_);
}

bool LockstepSolver::correct(ProjectiveSystem& system, StepReport& report) {
  // A swept particle is where the forces of contacts, as they are known, took it. It shall stay
  // there but for what these change: M/h² (x − y) = Jᵀλ there.
  find_contact_forces(system);
  Positions& x = system.particles.x;
  predicted_ = x;
  for (const auto& [begin, end] : corrected_->moved_by_others) {
    for (int i = begin; i < end; ++i) predicted_.col(i) -= answers_[i] * contact_.col(i);
    parts_.corrections->objective_.set_predicted(begin, predicted_.middleCols(begin, end - begin));
  }
  x.swap(corrected_->particles.x);
  parts_.corrections->compute_forces(*corrected_, report);
  const bool goes_on = parts_.corrections->iterate(*corrected_, report);
  x.swap(corrected_->particles.x);
  // However far the correction went, the forces that were found are those that act.
  find_contact_forces(system);
  for (const auto& [begin, end] : corrected_->moved_by_others) {
    for (int i = begin; i < end; ++i) x.col(i) = predicted_.col(i) + answers_[i] * contact_.col(i);
  }
  return goes_on;
}

void LockstepSolver::solve(ProjectiveSystem& system, double dt, StepReport& report) {
  objective_.begin_step(system);
  begin(system, report);
  const auto residual = [&] {
    objective_.forces(system, forces_, report);
    return objective_.relative_residual(system, forces_, report.iterations);
  };
  StopCheck stop(rule(), report);
  while (stop.next()) {
    if (stop.wants_residual(true)) {
      const double share = residual();
      if (stop.converged(report.iterations > 1 ? share : 1.0)) break;
    }
    sweep(system, dt, report);
    if (!correct(system, report)) stop.stall();
  }
  if (stop.is_residual_old()) stop.set_residual(residual());
  stop.warn_unless_converged();
  if (!estimates_error()) stop.warn_of_large_residual();
  parts_.corrections->end_iterations(*corrected_, report);
  end_step(system, answers_, report);
}

std::unique_ptr<Solver> make_lockstep(const Group& group) {
  return std::make_unique<LockstepSolver>(group);
}

}  // namespace pliant
