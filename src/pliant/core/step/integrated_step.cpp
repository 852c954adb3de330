#include "pliant/core/step/integrated_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/core/body.h"
#include "pliant/core/columns.h"
#include "pliant/core/group.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr std::string_view kImpact = "impact";
// No reason for a step of first order, but for one by what takes steps in contact.
constexpr std::string_view kInContact = "contact";
// Of a body's kinetic energy: what the jumps of velocities have in an impact that counts.
constexpr double kImpactShare = 0.01;
// Of a body's energy: what a step may gain that no force gave, besides what steps lost within the
// time kMemory [s] before it.
constexpr double kGained = 0.01, kMemory = 1.0;

double kinetic(const Particles& p, const Eigen::Matrix3Xd& v) {
  return parallel_sum(0, p.size(), kColumnGrain, [&](int i) {
    return p.is_fixed(i) ? 0.0 : 0.5 * p.mass[i] * v.col(i).squaredNorm();
  });
}

/// What a step's report says that is taken anew.
struct Told {
  explicit Told(const StepReport& report)
      : warnings(report.warnings.size()),
        error(report.error),
        imbalance(report.impulse_imbalance),
        gained(report.energy_gained),
        error_step(report.error_step) {}
  void restore(StepReport& report) const {
    report.forget_warnings(warnings);
    report.error = error;
    report.impulse_imbalance = imbalance;
    report.energy_gained = gained;
    report.error_step = error_step;
  }

  std::size_t warnings;
  std::optional<double> error, imbalance, gained;
  std::uint64_t error_step;
};

}  // namespace

IntegratedStep::IntegratedStep(Group& group, std::shared_ptr<const TimeIntegration> integration)
    : group_(group), integration_(std::move(integration)) {}

Particles& IntegratedStep::particles() const { return group_.system().particles; }

void IntegratedStep::check(const std::vector<Solver*>& solvers) const {
  for (Solver* solver : solvers) {
    if (solver->on_cpu().takes_time_integration()) continue;
    throw InputError(
        fmt::format("time_integration '{}' is for implicit solvers, and '{}' has a time "
                    "integration of its own: switch to time_integration 'implicit_euler' first",
                    integration_->name(), solver->name()));
  }
}

void IntegratedStep::prepare(double dt) {
  const double ratio = dt_ > 0.0 && effective_ > 0.0 ? effective_ / dt_ : 1.0;
  effective_ = ratio * dt;
  dt_ = dt;
  group_.solver().prepare(group_.system(), effective_);
}

void IntegratedStep::prepare_effective(double step) {
  if (step == effective_) return;
  StateArchive learned;
  group_.solver().save(learned);
  group_.solver().prepare(group_.system(), step);
  group_.solver().load(learned);
  effective_ = step;
}

void IntegratedStep::open_histories() {
  for (Body* body : group_.bodies()) {
    Particles& p = body->particles();
    std::swap(p.history, p.history_before);
    p.history.dt = 0.0;
    p.history.reserve = p.history_before.reserve;
    p.history.touched = false;
    p.inertia.is_used = false;
  }
}

std::string_view IntegratedStep::why_not() const {
  if (!group_.solver().takes_time_integration()) return "solvers";
  const auto& bodies = group_.bodies();
  const bool must = std::any_of(bodies.begin(), bodies.end(),
                                [](const Body* body) { return body->model->needs_first_order(); });
  return must ? "liquid" : "";
}

void IntegratedStep::warn_of_ignored(StepReport& report) const {
  if (!group_.solver().takes_time_integration()) {
    report.warn(fmt::format(
        "time_integration_ignored: bodies that may touch have different solvers, which take turns: "
        "they move by implicit Euler, not by '{}'; give them the same solver",
        integration_->name()));
  }
  for (const Body* body : group_.bodies()) {
    if (&body->solver->on_cpu() == body->solver.get()) continue;
    const auto asked = body->solver_setting.second.find("backend");
    if (asked == body->solver_setting.second.end() || asked->second != "cuda") {
      report.backend_reason = fmt::format("{} runs there alone", integration_->name());
      continue;
    }
    report.warn(fmt::format(
        "backend_ignored: body '{}' is moved on the CPU, since a GPU takes steps of implicit Euler "
        "alone: give time_integration 'implicit_euler' for the GPU",
        body->name));
  }
}

void IntegratedStep::begin_solver(double effective) {
  StepReport& report = group_.first().report;
  if (effective != effective_) {
    const ScopedPhase phase(report, "prepare");
    prepare_effective(effective);
  }
  group_.gather();
  report.time_integration = own_->name();
  group_.solver().begin_step(group_.system(), effective, report);
}

void IntegratedStep::begin(double dt) {
  dt_ = dt;
  learned_.clear();
  group_.solver().save(learned_);
  warn_of_ignored(group_.first().report);
  own_ = integration_.get();
  open_histories();
  first_order_ = why_not();
  // A step after one in contact is likely so too, and the solver is prepared for it.
  const bool was_in_contact = group_.first().particles().history_before.touched;
  if (first_order_.empty() && integration_->in_contact() != nullptr && was_in_contact) {
    begin_in_contact();
    if (!all_are_idle() || is_led()) return;
    retract();
    open_histories();
    own_ = integration_.get();
    first_order_ = {};
  }
  if (!first_order_.empty() || !begin_second_order()) begin_first_order();
}

void IntegratedStep::begin_in_contact() {
  own_ = integration_->in_contact();
  first_order_ = {};
  if (!begin_second_order()) begin_first_order();
}

bool IntegratedStep::is_led() const {
  return std::any_of(group_.bodies().begin(), group_.bodies().end(), [](const Body* body) {
    const ProjectiveSystem* system = body->model->system().as_projective();
    return system != nullptr && std::any_of(system->elements.begin(), system->elements.end(),
                                            [](const auto& set) { return set->is_moving(); });
  });
}

bool IntegratedStep::begin_second_order() {
  // Constraints would hold inside the step, but not at its end, and what holds a body is known
  // there.
  if (!own_->ends_with_solver() && is_led()) own_ = own_->in_contact();
  double effective = dt_;
  for (Body* body : group_.bodies()) {
    effective = std::min(effective, own_->begin_step(body->particles(), dt_));
  }
  if (effective == 0.0) {
    first_order_ = "start";
    return false;
  }
  begin_solver(effective);
  if (own_->ends_with_solver() || all_are_idle()) return true;
  retract();
  open_histories();
  begin_in_contact();
  return true;
}

void IntegratedStep::begin_first_order() {
  // From the step's beginning, as ever; but that it is said lets the solver keep the angular
  // momentum, of which a step of implicit Euler loses some.
  for (Body* body : group_.bodies()) {
    Particles& p = body->particles();
    InertialStart& start = p.inertia;
    start.is_used = true;
    start.share = 0.0;
    start.step = start.whole = dt_;
    start.x = p.x;
    start.v = p.v;
  }
  begin_solver(dt_);
}

void IntegratedStep::retract() {
  group_.hand_out();
  for (Body* body : group_.bodies()) {
    body->model->system().undo_step();
    for (const auto& effect : body->effects) effect->undo_step();
  }
  learned_.rewind();
  group_.solver().load(learned_);
}

void IntegratedStep::finish() {
  StepReport& report = group_.first().report;
  const Told told(report);
  group_.solver().finish_step(group_.system(), effective_, report);
  while (first_order_.empty()) {
    own_->end_step(particles());
    const std::string_view why = why_fall_back();
    if (why.empty()) break;
    retract();
    open_histories();
    told.restore(report);
    if (why == kInContact) {
      begin_in_contact();
    } else {
      first_order_ = why;
      begin_first_order();
    }
    take_again(report);
  }
  // Of a step in substeps the impact is told, or else what was first.
  if (report.first_order.empty() || has_hit()) report.first_order = first_order_;
  group_.hand_out();
}

void IntegratedStep::take_again(StepReport& report) {
  report.begin_substep();
  warn_of_ignored(report);
  group_.solver().finish_step(group_.system(), effective_, report);
}

bool IntegratedStep::has_hit() const { return first_order_ == kImpact; }

bool IntegratedStep::touches() const {
  const auto& constraints = group_.system().constraints;
  return std::any_of(constraints.begin(), constraints.end(),
                     [](const Constraint* constraint) { return constraint->active() > 0; });
}

bool IntegratedStep::all_are_idle() const {
  const auto& constraints = group_.system().constraints;
  return std::all_of(constraints.begin(), constraints.end(),
                     [](const Constraint* constraint) { return constraint->is_idle(); });
}

std::string_view IntegratedStep::why_fall_back() {
  const Particles& p = particles();
  if (!p.x.allFinite() || !p.v.allFinite()) return "energy";
  if (group_.solver().held_back()) return "energy";
  if (!own_->ends_with_solver()) {
    // The solver looked at a part of the path alone.
    for (Constraint* constraint : group_.system().constraints) constraint->begin_step(p, dt_);
    if (!all_are_idle()) return kInContact;
  }
  if (touches()) return has_impact() ? kImpact : "";
  return gains_energy() ? "energy" : "";
}

bool IntegratedStep::has_impact() {
  const Particles& p = particles();
  if (!(p.inertia.is_used && p.inertia.share > 0.0)) return false;
  forces_.setZero(3, p.size());
  for (const Constraint* constraint : group_.system().constraints) {
    // A volume presses everywhere, and changes no velocity at once.
    if (!constraint->is_collective()) constraint->add_forces(forces_);
  }
  int first = 0;
  for (const Body* body : group_.bodies()) {
    double jumped = 0.0, before = 0.0, after = 0.0;
    const int end = first + body->particles().size();
    for (int i = first; i < end; ++i) {
      if (p.is_fixed(i)) continue;
      before += p.mass[i] * p.v_start.col(i).squaredNorm();
      after += p.mass[i] * p.v.col(i).squaredNorm();
      if (forces_.col(i).isZero(0.0)) continue;
      const Eigen::Vector3d gained = (p.inertia.v.col(i) - p.v_start.col(i)) / p.inertia.share;
      jumped += p.mass[i] * (p.v.col(i) - p.v_start.col(i) - gained).squaredNorm();
    }
    if (jumped > kImpactShare * std::max(before, after)) return true;
    first = end;
  }
  return false;
}

bool IntegratedStep::gains_energy() {
  Particles& p = particles();
  const System& system = group_.system();
  const double after = kinetic(p, p.v) + system.elastic_energy();
  p.x.swap(p.x_start);
  const double before = kinetic(p, p.v_start) + system.elastic_energy();
  p.x.swap(p.x_start);
  const double work = parallel_sum(0, p.size(), kColumnGrain, [&](int i) {
    return system.external_forces.col(i).dot(p.x.col(i) - p.x_start.col(i));
  });
  const double gained = after - before - work;
  // What the material dissipates is lost for good. The positions may lie as much further than those
  // of the solver as the step is longer than its own.
  const double steps = own_->ends_with_solver() ? dt_ / effective_ : effective_ / dt_;
  const ProjectiveSystem* damped = group_.system().as_projective();
  const double dissipated = damped != nullptr ? 2.0 * steps * damped->viscous_energy() : 0.0;
  double& reserve = group_.first().particles().history.reserve;
  if (gained > kGained * std::max(before, after) + reserve) return true;
  reserve = std::max(0.0, reserve - gained - dissipated) * std::exp(-dt_ / kMemory);
  return false;
}

void IntegratedStep::remember(Body& body) const {
  Particles& p = body.particles();
  p.history.touched = own_ != integration_.get();
  // What an impact did has no continuation.
  if (has_hit()) return;
  p.history.moved = p.x - p.x_start;
  p.history.gained = p.v - p.v_start;
  p.history.dt = dt_;
}

}  // namespace pliant
