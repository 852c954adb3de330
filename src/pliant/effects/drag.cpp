#include "pliant/effects/drag.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/body.h"
#include "pliant/effects/attachment.h"
#include "pliant/math/error.h"
#include "pliant/math/pi.h"
#include "pliant/solvers/components/components.h"
#include "pliant/solvers/iterations/projective_solver.h"

namespace pliant {
namespace {

constexpr double kFrequency = 5.0;      // of a body on a spring that nobody chose [Hz]
constexpr double kAcceleration = 50.0;  // of a body by a force that nobody chose [m/s²]
// Of what an explicit step of loose particles bears, h² k / m < 4 and h c / m < 2, for spring and
// damper together: most is left for the body's own springs.
constexpr double kExplicitShare = 0.5;

void require_not_negative(const char* what, double value, const char* unit) {
  if (std::isfinite(value) && value >= 0.0) return;
  throw InputError(
      fmt::format("drag: {} is {} {}, but must be finite and >= 0; 0 takes what suits the mass",
                  what, value, unit));
}

/// Mass of what elements tie to some particles, their own where nothing does [kg].
double mass_tied_to(const std::vector<int>& held, Body& body) {
  const Particles& particles = body.particles();
  const ProjectiveSystem* system = body.model->system().as_projective();
  if (system == nullptr) return particles.mass.sum();
  const Components components = find_components(*system);
  std::vector<bool> is_meant(static_cast<std::size_t>(components.count()), false);
  for (const int i : held)
    is_meant[static_cast<std::size_t>(components.of[static_cast<std::size_t>(i)])] = true;
  double mass = 0.0;
  for (int i = 0; i < particles.size(); ++i) {
    const int own = components.of[static_cast<std::size_t>(i)];
    if (own != Components::kNone && is_meant[static_cast<std::size_t>(own)]) {
      mass += particles.mass[i];
    }
  }
  return mass;
}

}  // namespace

DragEffect& drag_of(Body& body) {
  if (DragEffect* found = body.find<DragEffect>()) return *found;
  auto own = std::make_unique<DragEffect>(body);
  DragEffect& effect = *own;
  body.effects.push_back(std::move(own));
  return effect;
}

Region region_to_grab(const Body& body, const Eigen::Vector3d& point, double radius) {
  Region region;
  region.kind = Region::Kind::kSphere;
  region.center = point;
  region.radius = radius;
  if (!free_particles_to_hold(body, region, 0, body.particles().size()).empty()) return region;
  const ForcePoints points = body.force_points();
  const bool are_particles = body.model->force_points() == nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < points.size(); ++i) {
    if (are_particles && body.particles().is_fixed(i)) continue;
    nearest = std::min(nearest, (points.position(i) - point).norm());
  }
  if (!std::isfinite(nearest)) {
    throw InputError(fmt::format("drag: no vertex of '{}' may move", body.name));
  }
  // Rounding must not leave it out.
  region.radius = nearest * (1.0 + 1e-9) + std::numeric_limits<double>::min();
  return region;
}

bool DragEffect::is_implicit() const { return body_.solver->on_cpu().is_implicit(); }

void DragEffect::choose(const std::vector<int>& held, const DragSpring& spring) {
  mass_ = mass_tied_to(held, body_);
  const double speed = 2.0 * kPi * kFrequency;  // [1/s]
  stiffness_ = spring.stiffness > 0.0 ? spring.stiffness : mass_ * speed * speed;
  force_limit_ = spring.force_limit > 0.0 ? spring.force_limit : mass_ * kAcceleration;
  damping_ = 2.0 * std::sqrt(stiffness_ * mass_);
}

/// What bears the spring in one step of `h` seconds: more would carry the body beyond the hand.
double DragEffect::largest_firmness(double h) const {
  if (!was_implicit_) return kExplicitShare * held_mass_ / (h * h);
  return mass_ / (h * h);
}

void DragEffect::hold(const std::vector<int>& held, double dt) {
  const Particles& particles = body_.particles();
  held_mass_ = 0.0;
  for (const int i : held) held_mass_ += particles.mass[i];
  was_implicit_ = is_implicit();
  // E = ½ k |x - a|² + ½ c/h |x - x_start|² is one spring of stiffness k + c/h.
  const double h = body_.solver_dt > 0.0 ? body_.solver_dt : dt;
  const double most = largest_firmness(h);
  stiffness_ = std::min(stiffness_, 0.5 * most);
  damping_ = std::min(damping_, (most - stiffness_) * h);
  firmness_ = was_implicit_ ? stiffness_ + damping_ / h : stiffness_;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const int i : held) center += particles.mass[i] / held_mass_ * particles.x.col(i);
  set_->clear();
  set_->limit_force(force_limit_);
  set_->tell_force(Eigen::Vector3d::Zero());
  for (const int i : held) {
    set_->add(i, particles.x.col(i) - center, firmness_ * particles.mass[i] / held_mass_);
  }
  set_->set_frame(Eigen::Isometry3d(Eigen::Translation3d(center)));
  prepare_again(body_, dt);
}

int DragEffect::grab(const Region& region, const DragSpring& spring, double dt) {
  require_not_negative("the stiffness", spring.stiffness, "N/m");
  require_not_negative("the limit of the force", spring.force_limit, "N");
  const std::vector<int> held = free_particles_to_hold(body_, region, 0, body_.particles().size());
  if (held.empty()) throw InputError("drag: no vertex that may move is in the region");
  if (set_ == nullptr) set_ = &new_attachment_set(body_);
  choose(held, spring);
  hold(held, dt);
  is_loaded_ = false;
  target_ = center();
  return set_->size();
}

void DragEffect::move_to(const Eigen::Vector3d& point) {
  if (!point.allFinite()) {
    throw InputError(fmt::format("drag: the point ({}, {}, {}) m is not finite", point.x(),
                                 point.y(), point.z()));
  }
  target_ = point;
}

void DragEffect::let_go(double dt) {
  if (!is_holding()) return;
  set_->clear();
  prepare_again(body_, dt);
}

Eigen::Vector3d DragEffect::center() const {
  const Particles& particles = body_.particles();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const AttachmentSet::Attachment& held : set_->attachments()) {
    center += particles.mass[held.particle] / held_mass_ * particles.x.col(held.particle);
  }
  return center;
}

Eigen::Vector3d DragEffect::force() const {
  if (!is_holding()) return Eigen::Vector3d::Zero();
  const Particles& particles = body_.particles();
  if (body_.model->system().as_projective() == nullptr) return set_->told_force();
  return -set_->wrench(particles.x).head<3>();
}

void DragEffect::before_step(Body& body, double dt) {
  if (is_loaded_) {
    StateArchive learned;
    body.solver->save(learned);
    prepare_again(body, dt);
    body.solver->load(learned);
    is_loaded_ = false;
  }
  if (!is_holding()) return;
  if (is_implicit() != was_implicit_) {
    std::vector<int> held;
    for (const AttachmentSet::Attachment& a : set_->attachments()) held.push_back(a.particle);
    hold(held, dt);
  }
  const Particles& particles = body.particles();
  const Eigen::Vector3d start = center();
  const Forces& forces = body.model->system().external_forces;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero(), acceleration = Eigen::Vector3d::Zero();
  for (const AttachmentSet::Attachment& held : set_->attachments()) {
    velocity += particles.mass[held.particle] / held_mass_ * particles.v.col(held.particle);
    acceleration += forces.col(held.particle) / held_mass_;
  }
  // Where the springs have to begin so that they pull as spring and damper do. The spring alone is
  // limited, so that the damper still brakes what a spring that is too long accelerates.
  Eigen::Vector3d stretch = target_ - start;
  const double too_long = stiffness_ * stretch.norm() / force_limit_;
  if (too_long > 1.0) stretch /= too_long;
  Eigen::Vector3d place = start + stiffness_ / firmness_ * stretch;
  Eigen::Vector3d free_end = start;
  if (!was_implicit_) {
    place -= damping_ / firmness_ * velocity;
  } else {
    free_end += dt * velocity + dt * dt * acceleration;
  }
  const Eigen::Vector3d pull = firmness_ * (place - free_end);
  const double over = pull.norm() / force_limit_;
  // A reduced body knows how it answers, and keeps the limit itself.
  const bool is_known = body.model->system().as_projective() == nullptr;
  if (over > 1.0 && !is_known) place = free_end + pull / (over * firmness_);
  set_->set_frame(Eigen::Isometry3d(Eigen::Translation3d(place)));
}

void DragEffect::reset(Body&) {
  if (set_ != nullptr) set_->clear();
  is_loaded_ = false;
}

void DragEffect::save(StateArchive& numbers) const {
  numbers.write(set_ != nullptr ? 1.0 : 0.0);
  if (set_ == nullptr) return;
  set_->write(numbers);
  numbers.write_all(target_);
  for (const double value : {stiffness_, force_limit_, damping_, mass_, held_mass_, firmness_,
                             was_implicit_ ? 1.0 : 0.0}) {
    numbers.write(value);
  }
  numbers.write_all(set_->told_force());
}

void DragEffect::load(StateArchive& numbers) {
  if (numbers.read() == 0.0) return;
  if (set_ == nullptr) set_ = &new_attachment_set(body_);
  set_->read(numbers);
  numbers.read_all(target_);
  for (double* value : {&stiffness_, &force_limit_, &damping_, &mass_, &held_mass_, &firmness_}) {
    *value = numbers.read();
  }
  was_implicit_ = numbers.read() == 1.0;
  set_->limit_force(force_limit_);
  Eigen::Vector3d told;
  numbers.read_all(told);
  set_->tell_force(told);
  is_loaded_ = true;
}

}  // namespace pliant
