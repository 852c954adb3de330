#include "pliant/core/group.h"

#include <algorithm>
#include <utility>

#include "pliant/core/body.h"
#include "pliant/core/step/body_integration.h"

namespace pliant {
namespace {

std::vector<System*> systems_of(const std::vector<Body*>& bodies) {
  std::vector<System*> systems;
  for (Body* body : bodies) systems.push_back(&body->model->system());
  return systems;
}

}  // namespace

Group::Group(Body& body) : bodies_{&body} { body.group = this; }

Group::Group(std::vector<Body*> bodies, LockstepFactory make_lockstep)
    : bodies_(std::move(bodies)), make_lockstep_(std::move(make_lockstep)) {
  for (Body* body : bodies_) body->group = this;
  if (bodies_.size() > 1) joint_ = std::make_unique<JointSystem>(systems_of(bodies_));
}

Group::~Group() = default;

System& Group::system() const { return joint_ ? *joint_ : first().model->system(); }

Solver& Group::solver() const {
  Solver& solver = lockstep_ ? *lockstep_ : *first().solver;
  return integrated_ ? solver.on_cpu() : solver;
}

std::vector<Solver*> Group::solvers() const {
  std::vector<Solver*> all;
  for (const Body* body : bodies_) {
    if (std::find(all.begin(), all.end(), body->solver.get()) == all.end()) {
      all.push_back(body->solver.get());
    }
  }
  return all;
}

void Group::prepare_solver(double dt) {
  for (Body* body : bodies_) body->solver_dt = dt;
  const std::vector<Solver*> all = solvers();
  if (std::find(all.begin(), all.end(), nullptr) != all.end()) return;
  if (integrated_) integrated_->check(all);
  if (all.size() == 1) {
    lockstep_.reset();
    in_step_.clear();
  } else if (all != in_step_) {
    // Where it throws, nothing has changed.
    lockstep_ = make_lockstep_(*this);
    in_step_ = all;
  }
  if (joint_) joint_->rebuild();
  if (integrated_) {
    integrated_->prepare(dt);
  } else {
    solver().prepare(system(), dt);
  }
}

void Group::set_time_integration(std::shared_ptr<const TimeIntegration> integration) {
  std::unique_ptr<IntegratedStep> old = std::move(integrated_);
  if (integration) integrated_ = std::make_unique<IntegratedStep>(*this, std::move(integration));
  try {
    if (first().solver_dt > 0.0) prepare_solver(first().solver_dt);
  } catch (...) {
    integrated_ = std::move(old);
    throw;
  }
  for (Body* body : bodies_) {
    body->particles().inertia.is_used = false;
    // Implicit Euler remembers nothing: what stands there is old.
    if (old == nullptr) body->particles().history = MotionHistory();
  }
}

std::string_view time_integration_of(const Body& body) {
  const IntegratedStep* integrated = body.group->integrated();
  if (integrated != nullptr) return integrated->integration().name();
  return body.group->solver().on_cpu().takes_time_integration() ? kImplicitEuler
                                                                : std::string_view();
}

void Group::begin_step(double dt) {
  if (integrated_) {
    integrated_->begin(dt);
    return;
  }
  gather();
  StepReport& report = first().report;
  if (solver().on_cpu().takes_time_integration()) report.time_integration = kImplicitEuler;
  solver().begin_step(system(), dt, report);
}

void Group::finish_step(double dt) {
  if (integrated_) {
    integrated_->finish();
    return;
  }
  solver().finish_step(system(), dt, first().report);
  hand_out();
}

void Group::gather() const {
  if (joint_) joint_->take();
}

void Group::hand_out() const {
  if (!joint_) return;
  joint_->give();
  for (Body* body : bodies_) {
    // Of bodies of coordinates no error is known: what is told is that of element sets.
    const bool is_estimated = body->model->system().as_projective() != nullptr;
    if (body != &first() && is_estimated) body->report.take_solver_from(first().report);
    if (lockstep_) body->report.solver = body->solver->name();
  }
  if (first().model->system().as_projective() == nullptr) first().report.error.reset();
}

}  // namespace pliant
