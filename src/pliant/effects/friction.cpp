#include "pliant/effects/friction.h"

#include <Eigen/Geometry>

#include "pliant/core/body.h"

namespace pliant {
namespace {
// A friction force below this share of its bound holds its particle: it sticks.
constexpr double kSticks = 1.0 - 1e-9;
}  // namespace

FrictionEffect::FrictionEffect(ContactEffect& contact, const std::vector<Obstacle>& obstacles,
                               double coefficient)
    : contact_(contact), obstacles_(obstacles), coefficient_(coefficient) {}

void FrictionEffect::begin_step(const Particles& particles, double) { particles_ = &particles; }

double FrictionEffect::bound(const Contact& contact) const {
  const auto& own = obstacles_[static_cast<std::size_t>(contact.obstacle)].friction;
  return own.value_or(coefficient_) * contact.normal_force;
}

Eigen::Vector3d FrictionEffect::slip(const Contact& contact, const Positions& x) const {
  const Eigen::Vector3d way =
      x.col(contact.particle) - particles_->x_start.col(contact.particle) - contact.surface_motion;
  return way - contact.normal * contact.normal.dot(way);
}

bool FrictionEffect::sticks(const Contact& contact, const Eigen::Vector3d& way) const {
  if (contact.friction_force.norm() < kSticks * bound(contact)) return true;
  // It slid, and now it slides back: the truth lies between.
  return way.isZero(0.0) || way.dot(contact.slide) < 0.0;
}

void FrictionEffect::add_rows(const Positions& x, CouplingRows& rows) {
  for (Contact& contact : contact_.contacts()) {
    if (contact.corrections == 0) continue;
    if (contact.corrections == 1) {
      // The normal force of a contact that no correction has held yet is a first guess, far too
      // large: the friction it allows would be so too.
      contact.friction_force.setZero();
      contact.slide.setZero();
      continue;
    }
    const Eigen::Vector3d way = slip(contact, x);
    if (!sticks(contact, way)) {
      // The force -b s/|s| turns with the way s: across it, it has the stiffness b/|s|.
      contact.slide = way.normalized();
      rows.begin_row(0.0, way.norm() / bound(contact));
      rows.add(contact.particle, contact.normal.cross(contact.slide));
      continue;
    }
    contact.slide.setZero();
    const bool at_rest = contact.friction_force.norm() < kSticks * bound(contact);
    const Eigen::Vector3d along = contact.normal.unitOrthogonal();
    for (const Eigen::Vector3d& tangent : {along, Eigen::Vector3d(contact.normal.cross(along))}) {
      rows.begin_row(at_rest ? 0.0 : -tangent.dot(way), 0.0);
      rows.add(contact.particle, tangent);
    }
  }
}

void FrictionEffect::relax(const Eigen::VectorXd& mobility, Positions& x) {
  for (Contact& contact : contact_.contacts()) {
    const int i = contact.particle;
    if (contact.normal_force == 0.0 && contact.friction_force.isZero(0.0)) continue;
    if (mobility[i] == 0.0) continue;
    // The force that would stop the slip, cut to the cone |f_t| <= mu f_n.
    Eigen::Vector3d force = contact.friction_force - slip(contact, x) / mobility[i];
    const double size = force.norm();
    const double largest = bound(contact);
    if (size > largest) force *= largest / size;
    x.col(i) += mobility[i] * (force - contact.friction_force);
    contact.friction_force = force;
  }
}

EffectRegistry::Entry friction_entry() {
  return {"friction",
          "Coulomb friction at contacts; needs the effect contact",
          {number_parameter("coefficient", "", "0.5", 0.0, 100.0,
                            "static and dynamic; an obstacle's own `friction` replaces it")},
          {"cloth"},
          [](const Parameters& parameters, const EffectSite& site) {
            auto* contact = dynamic_cast<ContactEffect*>(site.body.find_effect("contact"));
            if (contact == nullptr) {
              throw InputError(
                  "effect 'friction' needs the effect 'contact': add `contact:` to effects");
            }
            return std::make_unique<FrictionEffect>(*contact, site.obstacles,
                                                    parameters.number("coefficient"));
          }};
}

}  // namespace pliant
