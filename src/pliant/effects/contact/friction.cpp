#include "pliant/effects/contact/friction.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "pliant/core/body.h"
#include "pliant/effects/contact/contact_sweeps.h"
#include "pliant/laws/coulomb.h"
#include "pliant/math/vector_traits_eigen.h"

namespace pliant {
namespace {
// A friction force below this share of its bound holds its particle: it sticks.
constexpr double kSticks = 1.0 - 1e-9;
// Of the offset: what no solver bends a rigid body by.
constexpr double kMostBend = 0.5;

RestoredShape::Touching touching(const Contact& contact) { return {contact.obstacle, 0}; }

}  // namespace

FrictionEffect::FrictionEffect(ContactEffect& contact, const std::vector<Obstacle>& obstacles,
                               double coefficient)
    : contact_(contact), obstacles_(obstacles), coefficient_(coefficient) {}

void FrictionEffect::begin_step(const Particles& particles, double) {
  particles_ = &particles;
  restored_.begin_step();
  if (!restored_.owes(particles.x)) return;
  for (Contact& contact : contact_.contacts()) {
    const Eigen::Vector3d by = contact_.points().position(restored_.by(), contact.point);
    if (!restored_.owes(touching(contact), by, kMostBend * contact_.offset())) continue;
    contact.owed = by - contact.normal * contact.normal.dot(by);
  }
}

void FrictionEffect::final_projection(const Eigen::VectorXd&, Positions& x) {
  if (contact_.keeps_shape()) restored_.note_bent(x);
}

void FrictionEffect::after_step(Body&, double) {
  // A GPU may have taken the step, and asked nothing here.
  if (particles_ == nullptr) return;
  for (const Contact& contact : contact_.contacts()) {
    const bool has_stuck = contact.friction_force.norm() < kSticks * bound(contact);
    if (has_stuck && restored_.has_bent()) restored_.note_stuck(touching(contact));
  }
  // Where nothing got a shape back, nothing is owed any more.
  restored_.end_step(particles_->x);
}

void FrictionEffect::undo_step() { restored_.undo_step(); }

void FrictionEffect::reset(Body&) { restored_.reset(); }

void FrictionEffect::save(StateArchive& numbers) const { restored_.save(numbers); }

void FrictionEffect::load(StateArchive& numbers) { restored_.load(numbers); }

double FrictionEffect::coefficient(const Contact& contact) const {
  const auto& own = obstacles_[static_cast<std::size_t>(contact.obstacle)].friction;
  return own.value_or(coefficient_);
}

double FrictionEffect::bound(const Contact& contact) const {
  // What water pulls presses as well (Derjaguin 1934). Round-off may leave less than none.
  const double pressing = std::max(0.0, contact.normal_force + contact.adhesion);
  return contact.friction_factor * coefficient(contact) * pressing;
}

Eigen::Vector3d FrictionEffect::slip(const Contact& contact, const Positions& x) const {
  const ContactPoints& points = contact_.points();
  const Eigen::Vector3d displacement = points.position(x, contact.point) -
                                       points.position(particles_->x_start, contact.point) -
                                       contact.surface_motion + contact.owed;
  return displacement - contact.normal * contact.normal.dot(displacement);
}

Eigen::VectorXd FrictionEffect::losses(const Positions& x) const {
  Eigen::VectorXd losses = Eigen::VectorXd::Zero(x.cols());
  for (const Contact& contact : contact_.contacts()) {
    const Obstacle& obstacle = obstacles_[static_cast<std::size_t>(contact.obstacle)];
    // A force that iterations left pointing along the slip took nothing.
    const double work = std::max(0.0, -contact.friction_force.dot(slip(contact, x)));
    losses[contact.point] += obstacle.temperature ? 0.5 * work : work;
  }
  return losses;
}

bool FrictionEffect::sticks(const Contact& contact, const Eigen::Vector3d& displacement) const {
  if (contact.friction_force.norm() < kSticks * bound(contact)) return true;
  // It slid, and now it slides back: the truth lies between.
  return displacement.isZero(0.0) || displacement.dot(contact.slide) < 0.0;
}

void FrictionEffect::add_rows(const Positions& x, ConstraintRows& rows) {
  for (Contact& contact : contact_.contacts()) {
    if (contact.corrections == 0) continue;
    if (contact.corrections == 1) {
      // The normal force of a contact that no correction has held yet is a first guess, far too
      // large: the friction it allows would be so too.
      contact.friction_force.setZero();
      contact.slide.setZero();
      continue;
    }
    const Eigen::Vector3d displacement = slip(contact, x);
    if (!sticks(contact, displacement)) {
      // The force -b s/|s| turns with the slip s: across it, it has the stiffness b/|s|.
      contact.slide = displacement.normalized();
      rows.begin_row(0.0, displacement.norm() / bound(contact));
      contact_.points().add_to_row(contact.point, contact.normal.cross(contact.slide), rows);
      continue;
    }
    contact.slide.setZero();
    const bool at_rest = contact.friction_force.norm() < kSticks * bound(contact);
    const Eigen::Vector3d along = contact.normal.unitOrthogonal();
    for (const Eigen::Vector3d& tangent : {along, Eigen::Vector3d(contact.normal.cross(along))}) {
      rows.begin_row(at_rest ? 0.0 : -tangent.dot(displacement), 0.0);
      contact_.points().add_to_row(contact.point, tangent, rows);
    }
  }
}

void FrictionEffect::add_point_constraints(const Positions& x, PointConstraints& constraints) {
  const auto& contacts = contact_.contacts();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    PointConstraint& constraint = constraints.all[contact_.first_constraint() + c];
    constraint.friction = contacts[c].friction_factor * coefficient(contacts[c]);
    constraint.slip = slip(contacts[c], x);
    constraint.owed = contacts[c].owed;
  }
}

double FrictionEffect::relax(Contact& contact, const Eigen::VectorXd& mobility,
                             Positions& x) const {
  if (!contact.is_held() && contact.friction_force.isZero(0.0)) return 0.0;
  const double own = contact_.points().mobility(mobility, contact.point);
  if (own == 0.0) return 0.0;
  // The force that would stop the slip, cut to the cone |f_t| <= mu f_n.
  const Eigen::Vector3d force =
      within_disk<Eigen::Vector3d>(contact.friction_force - slip(contact, x) / own, bound(contact));
  const Eigen::Vector3d change = force - contact.friction_force;
  contact_.points().move(contact.point, change, mobility, x);
  contact.friction_force = force;
  return own * change.norm();
}

void FrictionEffect::relax(const Eigen::VectorXd& mobility, Positions& x) {
  if (!contact_.points().are_embedded()) {
    for (Contact& contact : contact_.contacts()) relax(contact, mobility, x);
    return;
  }
  for (Contact& contact : contact_.contacts()) {
    contact.friction_force += contact.friction_guess;
    contact_.points().move(contact.point, contact.friction_guess, mobility, x);
    contact.friction_guess.setZero();
  }
  sweep_to_rest(contact_.offset(), kMaxSweeps, [&] {
    double largest = 0.0;
    for (Contact& contact : contact_.contacts()) {
      largest = std::max(largest, relax(contact, mobility, x));
    }
    return largest;
  });
}

EffectRegistry::Entry friction_entry() {
  return {"friction",
          "Coulomb friction at contacts; needs the effect contact",
          {number_parameter("coefficient", "", "0.5", 0.0, 100.0,
                            "static and dynamic; an obstacle's own `friction` replaces it")},
          {"cloth", "patch", "reduced", "viscoelastic", "rigid"},
          [](const Parameters& parameters, const EffectSite& site) {
            auto* contact = site.body.find<ContactEffect>();
            if (contact == nullptr) {
              throw InputError(
                  "effect 'friction' needs the effect 'contact': add `contact:` to effects");
            }
            return std::make_unique<FrictionEffect>(*contact, site.obstacles,
                                                    parameters.number("coefficient"));
          }};
}

}  // namespace pliant
