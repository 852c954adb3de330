#include "pliant/effects/contact/pair_contact_effect.h"

#include <algorithm>
#include <utility>

#include "pliant/core/body.h"

namespace pliant {
namespace {
// Of the thickness: what iterations that did not know of a pair may leave to the final projection,
// which inertia alone answers.
constexpr double kLittle = 0.05;
// Of the thickness: what a change of velocity moves a pair in a step where it is hit.
constexpr double kImpact = 0.1;
}  // namespace

PairContactEffect::PairContactEffect(std::unique_ptr<PairDetection> detection, double thickness)
    : detection_(std::move(detection)),
      thickness_(thickness),
      pairs_(thickness, detection_->sweeps()),
      rest_(thickness, 1) {}

void PairContactEffect::reset(Body&) {
  pairs_.all().clear();
  forces_.clear();
}

void PairContactEffect::begin_step(const Particles& particles, double dt) {
  particles_ = &particles;
  dt_ = dt;
  has_rest_ = is_held_back_ = false;
  has_late_ = false;
  forces_before_ = forces_;
  keeps_forces_ = false;
  detection_->find(particles, dt, pairs_.all());
  found_first_ = pairs_.all().size();
}

void PairContactEffect::warm_start() {
  keeps_forces_ = true;
  for (PairContact& pair : pairs_.all()) {
    const PairForces::Known* known = forces_.find(pair.simplices);
    if (known == nullptr) continue;
    // The force of an impact is none that goes on.
    const Eigen::Vector3d change =
        pair.relative(particles_->v_start) - pair.relative(particles_->v_before);
    if (dt_ * change.norm() > kImpact * thickness_) continue;
    pair.normal_force = std::max(known->normal, -pair.adhesion);
    pair.friction_force = known->friction - pair.normal * pair.normal.dot(known->friction);
  }
}

void PairContactEffect::after_step(Body&, double) {
  forces_.clear();
  if (keeps_forces_) forces_.take(pairs_.all());
}

void PairContactEffect::undo_step() { forces_ = forces_before_; }

void PairContactEffect::save(StateArchive& numbers) const { forces_.save(numbers); }

void PairContactEffect::load(StateArchive& numbers) { forces_.load(numbers); }

void PairContactEffect::add_point_constraints(const Positions& x, PointConstraints& constraints) {
  first_constraint_ = constraints.all.size();
  for (std::size_t c = 0; c < pairs_.all().size(); ++c) {
    const PairContact& pair = pairs_.all()[c];
    PointConstraint& constraint = constraints.append();
    const Eigen::Vector3d relative = pair.relative(x);
    const Eigen::Vector3d path = relative - pair.start;
    constraint.normal = pair.normal;
    constraint.gap = pair.normal.dot(relative) - pair.least;
    constraint.slip = path - pair.normal * pair.normal.dot(path);
    constraint.owed = pair.owed;
    constraint.is_rigid = pair.is_rigid;
    constraint.is_late = c >= found_first_;
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

void PairContactEffect::find_late(const Positions& x) {
  if (has_late_ && late_at_ == x) return;
  late_.clear();
  detection_->find_again(*particles_, dt_, late_);
  late_at_ = x;
  has_late_ = true;
}

bool PairContactEffect::is_known(const PairContact& pair) const {
  return std::binary_search(known_.begin(), known_.end(), pair.simplices);
}

bool PairContactEffect::misses_any(const Positions& x) {
  const auto is_near = [&](const PairContact& pair) {
    return pair.least - pair.normal.dot(pair.relative(x)) > kLittle * thickness_;
  };
  const auto near = std::find_if(late_.begin(), late_.end(), is_near);
  if (near == late_.end()) return false;
  known_.clear();
  for (const PairContact& pair : pairs_.all()) known_.push_back(pair.simplices);
  std::sort(known_.begin(), known_.end());
  return std::any_of(near, late_.end(),
                     [&](const PairContact& pair) { return is_near(pair) && !is_known(pair); });
}

bool PairContactEffect::finds_more(const Positions& x, bool) {
  // What is between layers of one sheet weighs little, and its final projection is enough.
  if (detection_->is_final() || !is_between_bodies()) return false;
  find_late(x);
  if (!misses_any(x)) return false;
  for (const PairContact& pair : late_) {
    if (!is_known(pair)) pairs_.all().push_back(pair);
  }
  has_late_ = false;
  return true;
}

void PairContactEffect::final_projection(const Eigen::VectorXd& mobility, Positions& x) {
  if (detection_->is_final()) return;
  if (!is_between_bodies()) {
    detection_->find_again(*particles_, dt_, pairs_.all());
    pairs_.separate(mobility, x);
    return;
  }
  find_late(x);
  pairs_.all().insert(pairs_.all().end(), late_.begin(), late_.end());
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
