#include "pliant/effects/contact/pair_contact_effect.h"

#include <algorithm>
#include <utility>

#include "pliant/core/body.h"

namespace pliant {

PairContactEffect::PairContactEffect(std::unique_ptr<PairDetection> detection, double thickness)
    : detection_(std::move(detection)),
      pairs_(thickness, detection_->sweeps()),
      rest_(thickness, 1) {}

void PairContactEffect::reset(Body&) { pairs_.all().clear(); }

void PairContactEffect::begin_step(const Particles& particles, double dt) {
  particles_ = &particles;
  dt_ = dt;
  has_rest_ = is_held_back_ = false;
  detection_->find(particles, dt, pairs_.all());
}

void PairContactEffect::add_point_constraints(const Positions& x, PointConstraints& constraints) {
  first_constraint_ = constraints.all.size();
  for (const PairContact& pair : pairs_.all()) {
    PointConstraint& constraint = constraints.append();
    const Eigen::Vector3d relative = pair.relative(x);
    const Eigen::Vector3d path = relative - pair.start;
    constraint.normal = pair.normal;
    constraint.gap = pair.normal.dot(relative) - pair.least;
    constraint.slip = path - pair.normal * pair.normal.dot(path);
    constraint.lowest = -pair.adhesion;
    constraint.friction = pair.friction;
    constraint.normal_force = pair.normal_force;
    constraint.friction_force = pair.friction_force;
    for (std::size_t k = 0; k < pair.count; ++k) {
      constraints.add(pair.particles[k], pair.weights[k]);
    }
  }
}

void PairContactEffect::take_multipliers(const PointConstraints& constraints) {
  for (std::size_t c = 0; c < pairs_.all().size(); ++c) {
    const PointConstraint& constraint = constraints.all[first_constraint_ + c];
    pairs_.all()[c].normal_force = constraint.normal_force;
    pairs_.all()[c].friction_force = constraint.friction_force;
  }
}

void PairContactEffect::final_projection(const Eigen::VectorXd& mobility, Positions& x) {
  if (detection_->is_final()) return;
  detection_->find_again(*particles_, dt_, pairs_.all());
  if (!is_between_bodies()) {
    pairs_.separate(mobility, x);
    return;
  }
  // Nothing answers these moves any more but inertia: only by that are the forces that are told for
  // them equal to what they change of the momentum of either body.
  inertia_ = dt_ * dt_ * particles_->inverse_mass;
  pairs_.separate(inertia_, x);
}

double PairContactEffect::alternating_projection(const Eigen::VectorXd& mobility, Positions& x) {
  if (detection_->is_final()) return 0.0;
  return (has_rest_ ? rest_ : pairs_).alternating_projection(mobility, x);
}

bool PairContactEffect::limit_displacement(Positions& x) {
  is_held_back_ = !detection_->limit_displacement(*particles_, dt_, x, rest_.all());
  has_rest_ = has_rest_ || is_held_back_;
  return !is_held_back_;
}

bool PairContactEffect::is_crowded() const {
  return std::max(pairs_.all().size(), rest_.all().size()) > most_contacts();
}

void PairContactEffect::report(StepReport& report) const {
  report.contacts += active();
  if (const double search = detection_->take_search_seconds(); search > 0.0) {
    // A line of its own, beside what the effect takes otherwise.
    report.add_time(search_phase(), search);
    report.add_time(phase(), -search);
  }
  if (is_held_back_) report.warn(held_back());
}

}  // namespace pliant
