#include "pliant/effects/contact.h"

#include <algorithm>

#include "pliant/core/body.h"

namespace pliant {
namespace {

/// Projects one particle out of its contact: x += mobility n Δλ with λ + Δλ >= 0.
void project(Contact& contact, double mobility, Positions& x) {
  if (mobility == 0.0) return;
  const double gap = contact.normal.dot(x.col(contact.particle)) - contact.plane;
  const double delta = std::max(-gap / mobility, -contact.normal_force);
  contact.normal_force += delta;
  x.col(contact.particle) += mobility * delta * contact.normal;
}

}  // namespace

ContactEffect::ContactEffect(const std::vector<Obstacle>& obstacles, double thickness,
                             double margin)
    : obstacles_(obstacles), detection_(obstacles, 0.5 * thickness, margin) {}

void ContactEffect::begin_step(const Particles& particles, double dt) {
  particles_ = &particles;
  dt_ = dt;
  contacts_.clear();
  detection_.find(particles, dt, contacts_);
}

void ContactEffect::reset_multipliers() {
  for (Contact& contact : contacts_) {
    contact.normal_force = 0.0;
    contact.friction_force.setZero();
  }
}

void ContactEffect::relax(const Eigen::VectorXd& mobility, Positions& x) {
  for (Contact& contact : contacts_) project(contact, mobility[contact.particle], x);
}

void ContactEffect::add_forces(Forces& f) const {
  for (const Contact& contact : contacts_) {
    f.col(contact.particle) += contact.normal_force * contact.normal + contact.friction_force;
  }
}

void ContactEffect::add_rows(const Positions&, CouplingRows& rows) {
  for (Contact& contact : contacts_) {
    contact.corrections = contact.normal_force > 0.0 ? contact.corrections + 1 : 0;
    if (contact.corrections == 0) continue;
    rows.begin_row(0.0, 0.0);
    rows.add(contact.particle, contact.normal);
  }
}

int ContactEffect::active() const {
  const auto loaded = [](const Contact& contact) { return contact.normal_force > 0.0; };
  return static_cast<int>(std::count_if(contacts_.begin(), contacts_.end(), loaded));
}

void ContactEffect::finish(const Eigen::VectorXd& mobility, Positions& x) {
  late_.clear();
  detection_.find(*particles_, dt_, late_);
  for (Contact& contact : late_) {
    project(contact, mobility[contact.particle], x);
    if (contact.normal_force > 0.0) contacts_.push_back(contact);
  }
}

void ContactEffect::report(StepReport& report) const { report.contacts += active(); }

void ContactEffect::add_reactions(std::vector<Reaction>& reactions) const {
  for (const Contact& contact : contacts_) {
    const auto o = static_cast<std::size_t>(contact.obstacle);
    const Eigen::Vector3d force = -(contact.normal_force * contact.normal + contact.friction_force);
    const Eigen::Vector3d arm =
        particles_->x.col(contact.particle) - obstacles_[o].pose_end.translation();
    reactions[o].force += force;
    reactions[o].torque += arm.cross(force);
  }
}

void ContactEffect::reset(Body&) { contacts_.clear(); }

EffectRegistry::Entry contact_entry() {
  return {"contact",
          "keeps particles out of obstacles and robot links, continuously in time, without bounce",
          {positive_parameter("thickness", "m", "0.002", 1.0,
                              "twice the distance that particles keep from surfaces"),
           number_parameter("margin", "m", "0.0005", 0.0, 1.0,
                            "contacts open by less than this take part in the iterations")},
          {"cloth"},
          [](const Parameters& parameters, const EffectSite& site) {
            return std::make_unique<ContactEffect>(site.obstacles, parameters.number("thickness"),
                                                   parameters.number("margin"));
          }};
}

}  // namespace pliant
