#include "pliant/core/group.h"

#include <algorithm>
#include <utility>

#include "pliant/core/body.h"

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

Solver& Group::solver() const { return lockstep_ ? *lockstep_ : *first().solver; }

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
  if (all.size() == 1) {
    lockstep_.reset();
    in_step_.clear();
  } else if (all != in_step_) {
    // Where it throws, nothing has changed.
    lockstep_ = make_lockstep_(*this);
    in_step_ = all;
  }
  if (joint_) joint_->rebuild();
  solver().prepare(system(), dt);
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
