#include "pliant/effects/friction.h"

#include "pliant/core/body.h"

namespace pliant {

FrictionEffect::FrictionEffect(ContactEffect& contact, const std::vector<Obstacle>& obstacles,
                               double coefficient)
    : contact_(contact), obstacles_(obstacles), coefficient_(coefficient) {}

void FrictionEffect::begin_step(const Particles& particles, double) { particles_ = &particles; }

void FrictionEffect::relax(const Eigen::VectorXd& mobility, Positions& x) {
  for (Contact& contact : contact_.contacts()) {
    const int i = contact.particle;
    if (contact.normal_force == 0.0 && contact.friction_force.isZero(0.0)) continue;
    if (mobility[i] == 0.0) continue;
    const auto& own = obstacles_[static_cast<std::size_t>(contact.obstacle)].friction;
    const double bound = own.value_or(coefficient_) * contact.normal_force;
    // The force that would stop the slip, cut to the cone |f_t| <= mu f_n.
    const Eigen::Vector3d slip = x.col(i) - particles_->x_start.col(i) - contact.surface_motion;
    const Eigen::Vector3d tangential = slip - contact.normal * contact.normal.dot(slip);
    Eigen::Vector3d force = contact.friction_force - tangential / mobility[i];
    const double size = force.norm();
    if (size > bound) force *= bound / size;
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
