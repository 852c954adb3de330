#include "pliant/solvers/iterations/projective_solver.h"

#include <algorithm>
#include <limits>

#include "pliant/core/columns.h"

namespace pliant {
namespace {
// In which alternating projections mend what final projections did to each other.
constexpr int kMaxRounds = 20;
// Straight pieces of a step at its end, where something would pass on one alone.
constexpr int kMaxPieces = 5;
}  // namespace

void ProjectiveSolver::prepare(System& system, double dt) {
  dt_ = dt;
  for (const auto& set : static_cast<ProjectiveSystem&>(system).elements) set->prepare(dt);
  prepare_system(static_cast<ProjectiveSystem&>(system), dt);
  if (control_.is_on()) {
    control_.set_residual_share(residual_share(static_cast<ProjectiveSystem&>(system)));
  }
  error_.prepare(static_cast<ProjectiveSystem&>(system));
  error_.set_price(iteration_price());
  momentum_.prepare(static_cast<ProjectiveSystem&>(system), dt);
  imbalance_.prepare(static_cast<ProjectiveSystem&>(system));
  guard_.prepare(dt);
}

void ProjectiveSolver::step(System& system, double dt, StepReport& report) {
  begin_step(system, dt, report);
  finish_step(system, dt, report);
}

void ProjectiveSolver::begin_step(System& base, double dt, StepReport& report) {
  auto& system = static_cast<ProjectiveSystem&>(base);
  Particles& particles = system.particles;
  report.solver = name();
  if (report.step == 1) forget();
  {
    ScopedPhase phase(report, "predict");
    add_predicted_forces(system, system.external_forces);
    predict(system, dt);
    for (const auto& set : system.elements) set->begin_step(particles);
  }
  move_others(system, dt);
  for (Constraint* constraint : system.constraints) {
    ScopedPhase phase(report, constraint->name());
    constraint->begin_step(particles, dt);
  }
  begin_solve(system, dt, report);
}

void ProjectiveSolver::finish_step(System& base, double dt, StepReport& report) {
  auto& system = static_cast<ProjectiveSystem&>(base);
  solve(system, dt, report);
  if (control_.is_on() && !estimates_error()) {
    report.warn(
        "error_ignored: the error of such a body is not estimated (liquid, loose particles or "
        "more than 30,000 vertices), so that nothing adapts to the asked 'error': give "
        "'iterations' or 'tolerance'");
  }
  if (estimates_error()) {
    ScopedPhase phase(report, "error_estimate");
    if (control_.is_on()) {
      if (report.ended_by == control_.ended_by()) report.ended_by = EndedBy::kError;
      error_.watch_closely();
    }
    if (error_.observe(system, dt, cure(), report)) {
      control_.learn(error_.lasting(), std::min(report.iterations, rule().iterations));
    }
    if (control_.is_missed_by(report.error.value_or(0.0))) {
      report.warn(control_.is_at_end()
                      ? "error_missed: the estimated error is more than twice the asked one, with "
                        "as many iterations as may be taken or help: raise 'most_iterations' (of "
                        "newton 'iterations'), or "
                        "take a smaller time step, lbfgs or newton"
                      : "error_missed: the estimated error is more than twice the asked one; "
                        "iterations still grow: wait, or take a smaller time step, lbfgs or "
                        "newton");
    }
  }
  {
    const ScopedPhase phase(report, "velocity");
    find_velocities(system, dt, report);
  }
  tell_laws(system, dt, report);
  end_others(system, dt);
  for (const Constraint* constraint : system.constraints) constraint->report(report);
}

void ProjectiveSolver::forget() {
  control_.forget();
  error_.forget();
  guard_.forget();
}

void ProjectiveSolver::tell_laws(const ProjectiveSystem& system, double dt, StepReport& report) {
  if (is_implicit() && imbalance_.is_known()) {
    const ScopedPhase phase(report, "momentum");
    const double imbalance = imbalance_.find(system, dt);
    report.impulse_imbalance = std::max(imbalance, report.impulse_imbalance.value_or(0.0));
  }
  if (is_guarded_ && guard_.is_known()) {
    report.energy_gained = guard_.gained() + report.energy_gained.value_or(0.0);
  }
}

void ProjectiveSolver::find_velocities(ProjectiveSystem& system, double dt, StepReport& report) {
  Particles& p = system.particles;
  const Positions& origin = p.x_inertial();
  const auto take_displacements = [&] {
    for_each_column(p.x, [&](int i) { p.v.col(i) = (p.x.col(i) - origin.col(i)) / dt; });
  };
  take_displacements();
  if (momentum_.is_missed_by(1.0, system, dt)) {
    StepEnergy::warn(report);
    held_back_ = true;
    momentum_.lose();
    return;
  }
  if (!corrects_velocities(system)) momentum_.lose_above(most_momentum_left(), system, dt);
  if (!momentum_.correct_velocities(system)) return;
  // Forces that would make so much energy are none.
  if (!is_guarded_ || guard_.allows(p)) return;
  StepEnergy::warn(report);
  held_back_ = true;
  take_displacements();
}

void ProjectiveSolver::save(StateArchive& numbers) const {
  control_.save(numbers);
  error_.save(numbers);
  guard_.save(numbers);
  save_learned(numbers);
}

void ProjectiveSolver::load(StateArchive& numbers) {
  control_.load(numbers);
  error_.load(numbers);
  guard_.load(numbers);
  load_learned(numbers);
}

void ProjectiveSolver::predict(ProjectiveSystem& system, double dt) {
  Particles& p = system.particles;
  p.x_start.swap(p.x);
  p.v_before.swap(p.v_start);
  p.v_start.swap(p.v);
  const Forces& f = system.external_forces;
  const Positions& origin = p.x_inertial();
  const Eigen::Matrix3Xd& velocity = p.v_inertial();
  // x = x* + h* v* + h*² f / m; fixed particles stay.
  for_each_column(p.x, [&](int i) {
    const double w = p.inverse_mass[i];
    if (w == 0.0) {
      p.x.col(i) = p.x_start.col(i);
    } else {
      p.x.col(i) = origin.col(i) + dt * (velocity.col(i) + dt * w * f.col(i));
    }
  });
}

void ProjectiveSolver::reset_constraints(ProjectiveSystem& system) {
  for (Constraint* constraint : system.constraints) constraint->reset_multipliers();
}

void ProjectiveSolver::relax_constraints(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                         StepReport& report) {
  for (Constraint* constraint : system.constraints) {
    ScopedPhase phase(report, constraint->name());
    constraint->relax(mobility, system.particles.x);
  }
}

bool ProjectiveSolver::finds_more(ProjectiveSystem& system, StepReport& report) {
  if (report.iterations == 0) return false;
  const bool done = report.ended_by != EndedBy::kIterations && report.ended_by != EndedBy::kBudget;
  bool any = false;
  for (Constraint* constraint : system.constraints) {
    ScopedPhase phase(report, constraint->name());
    any = constraint->finds_more(system.particles.x, done) || any;
  }
  return any;
}

bool ProjectiveSolver::meets_contact(const ProjectiveSystem& system) {
  const auto& constraints = system.constraints;
  return std::any_of(constraints.begin(), constraints.end(),
                     [](const Constraint* constraint) { return constraint->active() > 0; });
}

bool ProjectiveSolver::gains_energy(ProjectiveSystem& system, StepReport& report) {
  {
    const ScopedPhase phase(report, "energy_guard");
    guard_.begin(system);
  }
  return still_gains_energy(system, report);
}

bool ProjectiveSolver::still_gains_energy(ProjectiveSystem& system, StepReport& report) {
  const ScopedPhase phase(report, "energy_guard");
  return guard_.gains(system);
}

void ProjectiveSolver::end_step(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                StepReport& report) {
  if (report.iterations > 0 && loses_momentum(system)) {
    const ScopedPhase phase(report, "momentum");
    momentum_.restore(system, mobility, dt_);
  }
  const bool corrects = corrects_velocities(system);
  is_guarded_ = report.iterations > 0 && guards_energy() && (meets_contact(system) || !corrects);
  bool is_rigid = false, is_held_back = false;
  held_back_ = is_guarded_ && gains_energy(system, report);
  if (held_back_) {
    const ScopedPhase phase(report, "momentum");
    is_rigid = stiffen(system, mobility);
    is_held_back = !is_rigid;
    StepEnergy::warn(report);
  }
  if (is_held_back) {
    guard_.hold_back(system);
    // The velocities will be those of the forces that were found, however far the step goes. Else
    // the next step would begin with forces that belong to no displacement.
    if (!corrects) reset_constraints(system);
  }
  // What iterations and solutions of linear equations left of momentum that no force tells. What
  // final projections change of it, in steps that end where iterations came, the velocities keep:
  // the forces that are told for them turn bodies that are gripped firmly.
  const bool left = report.iterations > 0 && (corrects || (leaves_momentum() && !is_held_back));
  if (left && !is_rigid) momentum_.compare(system, dt_);
  if (!system.constraints.empty()) final_projections(system, mobility, report);
  if (is_rigid) momentum_.compare(system, dt_);
  if (!is_guarded_) return;
  if (still_gains_energy(system, report)) {
    StepEnergy::warn(report);
    held_back_ = true;
    end_rigidly(system, mobility, report);
  }
  guard_.end(system);
}

void ProjectiveSolver::end_rigidly(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                   StepReport& report) {
  if (momentum_.can_move_rigidly(system)) {
    found_ = system.particles.x;
    momentum_.move_rigidly(system, found_, 0.0, mobility, dt_);
    final_projections(system, mobility, report);
    momentum_.compare(system, dt_);
    if (!guard_.gains(system)) return;
  }
  guard_.hold_back(system);
  reset_constraints(system);
  momentum_.lose();
}

bool ProjectiveSolver::stiffen(ProjectiveSystem& system, const Eigen::VectorXd& mobility) {
  if (!momentum_.can_move_rigidly(system)) return false;
  found_ = system.particles.x;
  for (const double share : {0.5, 0.25, 0.0}) {
    momentum_.move_rigidly(system, found_, share, mobility, dt_);
    system.keep_rigid(system.particles.x);
    // What a change of shape gains would be gained again in the next such step.
    if (share > 0.0 ? !guard_.gains_any(system) : !guard_.gains(system)) return true;
  }
  system.particles.x = found_;
  return false;
}

void ProjectiveSolver::final_projections(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                         StepReport& report) {
  for (Constraint* constraint : system.constraints) {
    ScopedPhase phase(report, constraint->name());
    constraint->final_projection(mobility, system.particles.x);
  }
  const auto& all = system.constraints;
  bool must_settle = std::any_of(all.begin(), all.end(), [](const Constraint* c) {
    return c->needs_alternating_projection();
  });
  for (int piece = 1;; ++piece) {
    if (must_settle) alternating_projections(system, mobility, report);
    // What is looked at is where all will be, rigid bodies in their shape.
    system.keep_rigid(system.particles.x);
    wanted_ = system.particles.x;
    if (limit_displacements(system, report) || piece == kMaxPieces) return;
    system.particles.x = wanted_;
    must_settle = true;
  }
}

void ProjectiveSolver::alternating_projections(ProjectiveSystem& system,
                                               const Eigen::VectorXd& mobility,
                                               StepReport& report) {
  double missed = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMaxRounds && missed > 1.0; ++round) {
    missed = 0.0;
    for (Constraint* constraint : system.constraints) {
      ScopedPhase phase(report, constraint->name());
      missed = std::max(missed, constraint->alternating_projection(mobility, system.particles.x));
    }
  }
}

bool ProjectiveSolver::limit_displacements(ProjectiveSystem& system, StepReport& report) {
  bool is_whole = true;
  for (Constraint* constraint : system.constraints) {
    ScopedPhase phase(report, constraint->name());
    is_whole = constraint->limit_displacement(system.particles.x) && is_whole;
  }
  return is_whole;
}

const std::vector<std::string>& projective_models() {
  static const std::vector<std::string> models = {"cloth", "patch", "viscoelastic", "rigid"};
  return models;
}

const std::vector<std::string>& deformable_models() {
  static const std::vector<std::string> models = {"cloth", "patch", "viscoelastic"};
  return models;
}

}  // namespace pliant
