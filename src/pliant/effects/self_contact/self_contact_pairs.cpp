#include "pliant/effects/self_contact/self_contact_pairs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/effects/contact/contact_sweeps.h"

namespace pliant {
namespace {

// A friction force below this share of its bound holds its pair: it sticks.
constexpr double kSticks = 1.0 - 1e-9;

// Pairs that a thread looks at at once.
constexpr int kGrain = 256;

// Sweeps over all pairs after the iterations, at the most.
constexpr int kMaxSeparations = 100;
// Share of the thickness that may be missing then.
constexpr double kLeftOver = 0.1;
// Of what should be between two places: where that cannot be, as in the tip of a fold that is
// sharper than the cloth is thick, this keeps them from passing; and what may be missing of it.
constexpr double kSettledShare = 0.3, kSettledLeftOver = 0.1;

/// How far a force of 1 N moves the places apart [m/N].
double mobility_of(const PairContact& contact, const Eigen::VectorXd& mobility) {
  double sum = 0.0;
  for (std::size_t k = 0; k < contact.count; ++k) {
    sum += contact.weights[k] * contact.weights[k] * mobility[contact.particles[k]];
  }
  return sum;
}

void move(const PairContact& contact, const Eigen::Vector3d& force, const Eigen::VectorXd& mobility,
          Positions& x) {
  for (std::size_t k = 0; k < contact.count; ++k) {
    const int i = contact.particles[k];
    x.col(i) += contact.weights[k] * mobility[i] * force;
  }
}

void add_row(const PairContact& contact, const Eigen::Vector3d& direction, double target,
             double compliance, ConstraintRows& rows) {
  rows.begin_row(target, compliance);
  for (std::size_t k = 0; k < contact.count; ++k) {
    rows.add(contact.particles[k], contact.weights[k] * direction);
  }
}

/// What water pulls presses as well (Derjaguin 1934). Round-off may leave less than none.
double friction_bound(const PairContact& contact) {
  return contact.friction * std::max(0.0, contact.normal_force + contact.adhesion);
}

/// Displacement of the point over the surface since the step began [m].
Eigen::Vector3d slip(const PairContact& contact, const Positions& x) {
  const Eigen::Vector3d displacement = contact.relative(x) - contact.start;
  return displacement - contact.normal * contact.normal.dot(displacement);
}

}  // namespace

void PairContacts::reset_multipliers() {
  for (PairContact& contact : contacts_) {
    contact.guess = contact.normal_force;
    contact.friction_guess = contact.friction_force;
    contact.normal_force = 0.0;
    contact.friction_force.setZero();
  }
}

double PairContacts::project(PairContact& contact, double own, const Eigen::VectorXd& mobility,
                             Positions& x) const {
  const double gap = contact.normal.dot(contact.relative(x)) - contact.least;
  const double delta = std::max(-gap / own, -contact.adhesion - contact.normal_force);
  if (delta == 0.0) return 0.0;
  contact.normal_force += delta;
  move(contact, delta * contact.normal, mobility, x);
  return std::abs(own * delta);
}

double PairContacts::rub(PairContact& contact, double own, const Eigen::VectorXd& mobility,
                         Positions& x) const {
  if (!contact.is_held() && contact.friction_force.isZero(0.0)) return 0.0;
  // The force that would stop the slip, cut to the cone |f_t| <= mu f_n.
  Eigen::Vector3d force = contact.friction_force - slip(contact, x) / own;
  const double size = force.norm(), largest = friction_bound(contact);
  if (size > largest) force *= largest / size;
  const Eigen::Vector3d change = force - contact.friction_force;
  move(contact, change, mobility, x);
  contact.friction_force = force;
  return own * change.norm();
}

void PairContacts::relax(const Eigen::VectorXd& mobility, Positions& x) {
  for (PairContact& contact : contacts_) {
    if (contact.guess == 0.0 && contact.friction_guess.isZero(0.0)) continue;
    contact.normal_force += contact.guess;
    contact.friction_force += contact.friction_guess;
    move(contact, contact.guess * contact.normal + contact.friction_guess, mobility, x);
    contact.guess = 0.0;
    contact.friction_guess.setZero();
  }
  sweep_to_rest(thickness_, sweeps_, [&] {
    double largest = 0.0;
    for (PairContact& contact : contacts_) {
      const double own = mobility_of(contact, mobility);
      if (own == 0.0) continue;
      largest = std::max(largest, project(contact, own, mobility, x));
      if (contact.friction > 0.0) largest = std::max(largest, rub(contact, own, mobility, x));
    }
    return largest;
  });
}

double PairContacts::missing(const PairContact& contact, const Eigen::VectorXd& mobility,
                             const Positions& x) {
  if (mobility_of(contact, mobility) == 0.0) return 0.0;
  return contact.least - contact.normal.dot(contact.relative(x));
}

void PairContacts::separate(const Eigen::VectorXd& mobility, Positions& x) {
  missing_.resize(contacts_.size());
  moved_.assign(static_cast<std::size_t>(x.cols()), -1);
  for (int sweep = 0; sweep < kMaxSeparations; ++sweep) {
    // Few are too near: threads look for them, and the sweep looks again where it moved something.
    parallel_for(0, static_cast<int>(contacts_.size()), kGrain, [&](int begin, int end) {
      for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
        missing_[k] = missing(contacts_[k], mobility, x);
      }
    });
    double deepest = 0.0;
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      PairContact& contact = contacts_[k];
      const auto last_moved = [&](std::size_t p) -> int& {
        return moved_[static_cast<std::size_t>(contact.particles[p])];
      };
      bool has_moved = false;
      for (std::size_t p = 0; p < contact.count; ++p) has_moved |= last_moved(p) == sweep;
      const double now = has_moved ? missing(contact, mobility, x) : missing_[k];
      if (!(now > 0.0)) continue;
      deepest = std::max(deepest, now);
      project(contact, mobility_of(contact, mobility), mobility, x);
      for (std::size_t p = 0; p < contact.count; ++p) last_moved(p) = sweep;
    }
    if (deepest <= kLeftOver * thickness_) break;
  }
}

double PairContacts::alternating_projection(const Eigen::VectorXd& mobility, Positions& x) const {
  double worst = 0.0;
  for (const PairContact& contact : contacts_) {
    const double own = mobility_of(contact, mobility);
    if (own == 0.0 || !(contact.least > 0.0)) continue;
    const double missing = kSettledShare * contact.least - contact.normal.dot(contact.relative(x));
    if (!(missing > 0.0)) continue;
    worst = std::max(worst, missing / (kSettledLeftOver * contact.least));
    move(contact, missing / own * contact.normal, mobility, x);
  }
  return worst;
}

void PairContacts::add_forces(Forces& f) const {
  for (const PairContact& contact : contacts_) {
    if (contact.normal_force == 0.0 && contact.friction_force.isZero(0.0)) continue;
    const Eigen::Vector3d force = contact.normal_force * contact.normal + contact.friction_force;
    for (std::size_t k = 0; k < contact.count; ++k) {
      f.col(contact.particles[k]) += contact.weights[k] * force;
    }
  }
}

void PairContacts::add_rows(const Positions& x, ConstraintRows& rows) {
  for (PairContact& contact : contacts_) {
    contact.corrections = contact.is_held() ? contact.corrections + 1 : 0;
    if (contact.corrections == 0) continue;
    add_row(contact, contact.normal, 0.0, 0.0, rows);
    if (contact.friction > 0.0) add_friction_rows(contact, x, rows);
  }
}

void PairContacts::add_friction_rows(PairContact& contact, const Positions& x,
                                     ConstraintRows& rows) const {
  if (contact.corrections == 1) {
    // The normal force of a contact that no correction has held yet is a first guess, far too
    // large: the friction it allows would be so too.
    contact.friction_force.setZero();
    contact.slide.setZero();
    return;
  }
  const double bound = friction_bound(contact);
  const Eigen::Vector3d displacement = slip(contact, x);
  const bool at_rest = contact.friction_force.norm() < kSticks * bound;
  // It slid, and now it slides back: the truth lies between.
  const bool turns = displacement.isZero(0.0) || displacement.dot(contact.slide) < 0.0;
  if (!at_rest && !turns) {
    // The force -b s/|s| turns with the slip s: across it, it has the stiffness b/|s|.
    contact.slide = displacement.normalized();
    add_row(contact, contact.normal.cross(contact.slide), 0.0, displacement.norm() / bound, rows);
    return;
  }
  contact.slide.setZero();
  const Eigen::Vector3d along = contact.normal.unitOrthogonal();
  for (const Eigen::Vector3d& tangent : {along, Eigen::Vector3d(contact.normal.cross(along))}) {
    add_row(contact, tangent, at_rest ? 0.0 : -tangent.dot(displacement), 0.0, rows);
  }
}

int PairContacts::active() const {
  return static_cast<int>(std::count_if(contacts_.begin(), contacts_.end(),
                                        [](const auto& c) { return c.normal_force != 0.0; }));
}

}  // namespace pliant
