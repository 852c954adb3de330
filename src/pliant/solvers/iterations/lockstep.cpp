#include "pliant/solvers/iterations/lockstep.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pliant/core/body.h"
#include "pliant/core/columns.h"
#include "pliant/math/error.h"
#include "pliant/solvers/components/rigid_clusters.h"
#include "pliant/solvers/iterations/direct.h"

namespace pliant {
namespace {

const char* const kAllowed =
    "bodies in contact take 'xpbd', also with different parameters, and one setting of 'direct', "
    "'lbfgs' or 'newton', or the same solver all of them; beside bodies of the model 'reduced' all "
    "but 'newton'";

// Where no body brings corrections: of loose particles, for contacts alone.
constexpr int kOwnCorrections = 10;
// How far contacts give way in one of those (FactoredSolver::set_contact_compliance): beside
// sweeps, which spread what it does, and where corrections alone move everything, stiff bodies of
// coordinates among it. A quarter left a stiff beam that falls on a plate a part in 10⁶ off after
// ten corrections, a fiftieth a part in 10⁹ after five; less drives rows that say the same apart.
constexpr double kComplianceBesideSweeps = 0.25, kCompliance = 0.02;
// With them, what a correction leaves to the next (FactoredSolver::set_contact_accuracy): forces
// that follow as stiffly settle later, displacements as soon.
constexpr double kAccuracyBesideSweeps = 0.01, kAccuracy = 0.1;
// Of a step's displacement, and of the size of the group: a correction that changes less agrees
// with the one before.
constexpr double kAgreement = 1e-7, kAgreementOfSize = 1e-9;

bool stops_early(const StopRule& rule) {
  return rule.tolerance > 0.0 || rule.budget > 0.0 || rule.error > 0.0;
}

/// Motion alone: who is free differs.
void take_motion(const Particles& from, Particles& to) {
  to.x = from.x;
  to.v = from.v;
  to.x_start = from.x_start;
  to.v_start = from.v_start;
  to.v_before = from.v_before;
}

}  // namespace

void LockstepSolver::take_corrections(const Body& body, Solver& solver, const Body*& corrected,
                                      Parts& parts) {
  if (solver.in_lockstep() != Solver::InLockstep::kCorrections) {
    throw InputError(
        fmt::format("solver '{}' of body '{}' cannot go together with those of the "
                    "bodies that it may touch: {}",
                    solver.name(), body.name, kAllowed));
  }
  auto* corrections = static_cast<FactoredSolver*>(&solver);
  if (corrected != nullptr && parts.corrections != corrections) {
    throw InputError(fmt::format("the solvers of bodies '{}' and '{}', which may touch, differ: {}",
                                 corrected->name, body.name, kAllowed));
  }
  corrected = &body;
  parts.corrections = corrections;
}

void LockstepSolver::warn_of_ignored(const Body& body, const Member& member, Parts& parts) {
  if (member.sweeps != nullptr && stops_early(member.sweeps->rule())) {
    parts.warnings.push_back(
        fmt::format("rule_ignored: 'tolerance', 'error' and 'budget' of 'xpbd' of body '{}' set "
                    "nothing, since solvers of other bodies take turns with it: give 'iterations'",
                    body.name));
  }
  if (&body.solver->on_cpu() != body.solver.get()) {
    parts.warnings.push_back(
        fmt::format("backend_ignored: body '{}' is moved on the CPU, since bodies in contact have "
                    "different solvers: give them the same one for the GPU",
                    body.name));
  }
}

void LockstepSolver::share_sweeps(Parts& parts) {
  const int corrections = std::max(1, parts.rule.iterations);
  for (Member& member : parts.members) {
    if (member.sweeps == nullptr) continue;
    member.count = std::max(1, (member.sweeps->rule().iterations + corrections - 1) / corrections);
    parts.sweeps = std::max(parts.sweeps, member.count);
  }
}

LockstepSolver::Parts LockstepSolver::parts_of(const Group& group) {
  Parts parts;
  const Body* corrected = nullptr;
  bool has_responders = false;
  for (Body* body : group.bodies()) {
    Solver& solver = body->solver->on_cpu();
    const Solver::InLockstep part = solver.in_lockstep();
    auto* xpbd = part == Solver::InLockstep::kSweeps ? static_cast<XpbdSolver*>(&solver) : nullptr;
    auto* own_steps = part == Solver::InLockstep::kStepsOfItsOwn ? &solver : nullptr;
    parts.members.push_back({body, &body->model->system(), xpbd, own_steps, 1});
    has_responders = has_responders || own_steps != nullptr;
    warn_of_ignored(*body, parts.members.back(), parts);
    if (xpbd == nullptr && own_steps == nullptr) {
      take_corrections(*body, solver, corrected, parts);
    }
  }
  if (parts.corrections == nullptr) {
    StopRule rule;
    rule.iterations = kOwnCorrections;
    parts.own_corrections = std::make_shared<DirectSolver>(rule);
    parts.corrections = parts.own_corrections.get();
  }
  if (has_responders &&
      static_cast<FactoredSolver*>(parts.corrections)->has_constraints_in_matrix()) {
    throw InputError(
        fmt::format("solver '{}' of body '{}' cannot find contacts with bodies of the "
                    "model 'reduced': {}",
                    parts.corrections->name(), corrected->name, kAllowed));
  }
  parts.rule = static_cast<ProjectiveSolver*>(parts.corrections)->rule();
  share_sweeps(parts);
  return parts;
}

LockstepSolver::LockstepSolver(const Group& group) : LockstepSolver(parts_of(group), group) {}

LockstepSolver::LockstepSolver(Parts parts, const Group& group)
    : ProjectiveSolver(parts.rule), parts_(std::move(parts)), group_(group) {}

/// Other corrections would take four times as long: they know no inverse of all that they move
/// which holds the rows of a rigid body in a few conjugate gradients.
bool LockstepSolver::answers_in_corrections(System& system) const {
  return parts_.own_corrections && is_made_of_rigid_bodies(*system.as_projective());
}

void LockstepSolver::prepare_system(const ProjectiveSystem& system, double dt) {
  const JointSystem& all = *group_.joint();
  std::vector<System*> systems;
  std::vector<bool> bare;
  swept_elements_.clear();
  swept_constraints_.clear();
  for (std::size_t m = 0; m < parts_.members.size(); ++m) {
    const Member& member = parts_.members[m];
    const int number = static_cast<int>(m);
    const bool sweeps_it = member.sweeps != nullptr && !answers_in_corrections(*member.system);
    systems.push_back(member.system);
    bare.push_back(sweeps_it);
    if (member.own_steps != nullptr) {
      member.system->as_responding()->keep_open(true);
      member.own_steps->prepare(*member.system, dt);
    }
    if (!sweeps_it) continue;
    for (ElementSet* set : all.elements_of(number)) swept_elements_.push_back({set, member.count});
    for (Constraint* own : all.constraints_of(number)) {
      swept_constraints_.push_back({own, member.count});
    }
  }
  moved_.resize(all.responders.size());
  if (parts_.own_corrections) {
    parts_.own_corrections->set_contact_compliance(is_swept() ? kComplianceBesideSweeps
                                                              : kCompliance);
    parts_.own_corrections->set_contact_accuracy(is_swept() ? kAccuracyBesideSweeps : kAccuracy);
  }
  corrected_ = std::make_unique<JointSystem>(systems, bare, JointSystem::Responders::kAnswer);
  for (Constraint* constraint : all.between()) corrected_->add_constraint(constraint);
  parts_.corrections->prepare(*corrected_, dt);
  objective_.prepare(system, dt);
  answers_ = dt * dt * system.particles.inverse_mass;
  corrected_answers_ = dt * dt * corrected_->particles.inverse_mass;
}

void LockstepSolver::move_others(ProjectiveSystem& system, double dt) {
  std::size_t k = 0;
  for (const Member& member : parts_.members) {
    if (member.own_steps == nullptr) continue;
    member.own_steps->step(*member.system, dt, member.body->report);
    const ProjectiveSystem::Responder& responder = system.responders[k];
    moved_[k] = member.system->particles.x;
    system.particles.x.middleCols(responder.begin, responder.size()) = moved_[k];
    ++k;
  }
}

void LockstepSolver::begin(ProjectiveSystem& system, StepReport& report) {
  reset_constraints(system);
  for (const auto& swept : swept_elements_) swept.what->reset_multipliers();
  // What the corrections see begins like all others.
  take_motion(system.particles, corrected_->particles);
  corrected_->external_forces = system.external_forces;
  parts_.corrections->objective_.begin_step(*corrected_);
  parts_.corrections->begin_iterations(*corrected_, report);
  // Contacts between bodies begin without forces: sweeps that have not spread yet what these do are
  // farther off with those of the last step (a strip over a ball and a box: 9 % instead of 4).
  for (Constraint* constraint : group_.joint()->between()) constraint->reset_multipliers();
}

void LockstepSolver::sweep(ProjectiveSystem& system, double dt, StepReport& report) {
  Positions& x = system.particles.x;
  for (int k = 0; k < parts_.sweeps; ++k) {
    for (const auto& [set, count] : swept_elements_) {
      if (k >= count) continue;
      ScopedPhase phase(report, set->name());
      set->relax(system.particles.inverse_mass, dt, x);
    }
    for (const auto& [constraint, count] : swept_constraints_) {
      if (k >= count) continue;
      ScopedPhase phase(report, constraint->name());
      constraint->relax(answers_, x);
    }
  }
}

void LockstepSolver::find_contact_forces(const ProjectiveSystem& system) {
  contact_.setZero(3, system.particles.size());
  for (const Constraint* constraint : group_.joint()->between()) constraint->add_forces(contact_);
}

void LockstepSolver::respond(std::size_t k, Positions& x) {
  const auto& [begin, end, system] = group_.joint()->responders[k];
  on_responder_ = contact_.middleCols(begin, end - begin);
  system->move(on_responder_, moved_[k]);
  x.middleCols(begin, end - begin) = moved_[k];
}

bool LockstepSolver::correct(ProjectiveSystem& system, StepReport& report) {
  // A swept particle is where the forces of contacts, as they are known, took it. It shall stay
  // there but for what these change: M/h² (x − y) = Jᵀλ there.
  find_contact_forces(system);
  Positions& x = system.particles.x;
  predicted_ = x;
  for (const auto& [begin, end] : corrected_->moved_by_others) {
    for (int i = begin; i < end; ++i) {
      predicted_.col(i) -= corrected_answers_[i] * contact_.col(i);
    }
    parts_.corrections->objective_.set_predicted(begin, predicted_.middleCols(begin, end - begin));
  }
  x.swap(corrected_->particles.x);
  parts_.corrections->compute_forces(*corrected_, report);
  const bool goes_on = parts_.corrections->iterate(*corrected_, report);
  x.swap(corrected_->particles.x);
  // However far the correction went, the forces that were found are those that act.
  find_contact_forces(system);
  for (const auto& [begin, end] : corrected_->moved_by_others) {
    for (int i = begin; i < end; ++i) {
      x.col(i) = predicted_.col(i) + corrected_answers_[i] * contact_.col(i);
    }
  }
  for (std::size_t k = 0; k < system.responders.size(); ++k) respond(k, x);
  return goes_on;
}

bool LockstepSolver::agrees(const ProjectiveSystem& system, const Positions& before) const {
  if (!parts_.own_corrections || is_swept()) return false;
  const Positions& start = system.particles.x_start;
  const double size = (start.colwise() - start.rowwise().mean()).norm();
  const double moved = (system.particles.x - start).norm();
  return (system.particles.x - before).norm() <= kAgreement * moved + kAgreementOfSize * size;
}

void LockstepSolver::solve(ProjectiveSystem& system, double dt, StepReport& report) {
  for (const std::string& warning : parts_.warnings) report.warn(warning);
  objective_.begin_step(system);
  begin(system, report);
  const auto residual = [&] {
    objective_.forces(system, forces_, report);
    return objective_.relative_residual(system, forces_, report.iterations);
  };
  StopCheck stop(rule(), report);
  const auto iterate_to_end = [&] {
    while (stop.next()) {
      if (stop.wants_residual(true)) {
        const double share = residual();
        if (stop.converged(report.iterations > 1 ? share : 1.0)) break;
      }
      sweep(system, dt, report);
      before_ = system.particles.x;
      if (!correct(system, report) || agrees(system, before_)) stop.stall();
    }
  };
  iterate_to_end();
  // Bodies of coordinates follow contact only as far as these can, and would be crushed.
  while (system.responders.empty() && finds_more(system, report) && stop.go_on()) {
    parts_.corrections->go_on();
    iterate_to_end();
  }
  if (stop.is_residual_old()) stop.set_residual(residual());
  stop.warn_unless_converged();
  if (!estimates_error()) stop.warn_of_large_residual();
  parts_.corrections->end_iterations(*corrected_, report);
  end_step(system, answers_, report);
}

double LockstepSolver::share_of_displacement(std::size_t k, const Particles& particles) const {
  const auto& [begin, end, system] = group_.joint()->responders[k];
  const auto start = particles.x_start.middleCols(begin, end - begin);
  const auto x = particles.x.middleCols(begin, end - begin);
  if (x == moved_[k]) return 1.0;
  const double squared = (moved_[k] - start).squaredNorm();
  return squared > 0.0 ? (x - start).cwiseProduct(moved_[k] - start).sum() / squared : 1.0;
}

void LockstepSolver::end_others(ProjectiveSystem& system, double dt) {
  if (system.responders.empty()) return;
  for (std::size_t k = 0; k < system.responders.size(); ++k) {
    system.responders[k].system->close(share_of_displacement(k, system.particles), dt);
  }
  impulses_.apply(system.responders, group_.joint()->between(), dt, system.particles);
  std::size_t k = 0;
  for (const Member& member : parts_.members) {
    if (member.own_steps == nullptr) continue;
    const auto& [begin, end, responding] = system.responders[k++];
    system.particles.x.middleCols(begin, end - begin) = member.system->particles.x;
    system.particles.v.middleCols(begin, end - begin) = member.system->particles.v;
  }
}

void LockstepSolver::save_learned(StateArchive& numbers) const {
  for (const Member& member : parts_.members) {
    if (member.own_steps != nullptr) member.own_steps->save(numbers);
  }
}

void LockstepSolver::load_learned(StateArchive& numbers) {
  for (const Member& member : parts_.members) {
    if (member.own_steps != nullptr) member.own_steps->load(numbers);
  }
}

std::unique_ptr<Solver> make_lockstep(const Group& group) {
  return std::make_unique<LockstepSolver>(group);
}

}  // namespace pliant
