#include "cuda/solvers/contact/contact_exchange.h"

#include "pliant/core/system/find_constraint.h"
#include "pliant/effects/contact/contact.h"
#include "pliant/effects/contact/friction.h"
#include "pliant/effects/self_contact/self_contact.h"

namespace pliant {
namespace {

Float4 packed(const Eigen::Vector3d& v, double w) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
          static_cast<float>(w)};
}

void set_particles(const ContactEffect& effect, int point, const EmbeddedPoints* embedded,
                   const std::vector<int>& place, DeviceContact& contact) {
  const auto at = [&](int particle) { return place[static_cast<std::size_t>(particle)]; };
  if (!effect.points().are_embedded()) {
    contact.particles = {{at(point), -1, -1, -1}};
    contact.weights = {1.0f, 0.0f, 0.0f, 0.0f};
    return;
  }
  const auto w = embedded->weights().col(point).cast<float>().eval();
  for (int a = 0; a < 4; ++a) contact.particles.v[a] = at(embedded->particles()(a, point));
  contact.weights = {w[0], w[1], w[2], w[3]};
}

void collect_obstacles(const ProjectiveSystem& system, const Positions& predicted,
                       const std::vector<int>& place, ContactTable& table) {
  const auto* effect = find_constraint<ContactEffect>(system.constraints);
  if (effect == nullptr) return;
  const auto* friction = find_constraint<FrictionEffect>(system.constraints);
  const Particles& particles = system.particles;
  table.embedded = effect->points().are_embedded();
  for (const Contact& contact : effect->contacts()) {
    if (effect->points().is_fixed(particles, contact.point)) continue;
    DeviceContact packed_contact;
    set_particles(*effect, contact.point, effect->points().embedded(), place, packed_contact);
    const Eigen::Vector3d at = effect->points().position(predicted, contact.point);
    packed_contact.plane = packed(contact.normal, contact.normal.dot(at) - contact.plane);
    const Eigen::Vector3d stuck =
        effect->points().position(particles.x_start, contact.point) + contact.surface_motion;
    packed_contact.slip = packed(at - stuck, friction ? friction->coefficient(contact) : 0.0);
    table.contacts.push_back(packed_contact);
  }
}

/// Two places of the body, whose difference is the point that its particles carry.
void collect_pairs(const ProjectiveSystem& system, const Positions& predicted,
                   const std::vector<int>& place, ContactTable& table) {
  const auto* effect = find_constraint<SelfContactEffect>(system.constraints);
  if (effect == nullptr) return;
  table.embedded = true;
  for (const PairContact& contact : effect->contacts()) {
    DeviceContact pair;
    pair.particles = {{-1, -1, -1, -1}};
    pair.weights = {0.0f, 0.0f, 0.0f, 0.0f};
    for (std::size_t k = 0; k < contact.count; ++k) {
      pair.particles.v[k] = place[static_cast<std::size_t>(contact.particles[k])];
      (&pair.weights.x)[k] = static_cast<float>(contact.weights[k]);
    }
    const Eigen::Vector3d at = contact.relative(predicted);
    pair.plane = packed(contact.normal, contact.normal.dot(at) - contact.least);
    pair.slip = packed(at - contact.start, contact.friction);
    table.contacts.push_back(pair);
  }
}

/// The next iteration begins with no guess: what the GPU did is whole.
template <class AnyContact>
void take(const DeviceContactForce& force, AnyContact& contact) {
  contact.normal_force = force.normal;
  contact.friction_force = Eigen::Vector3d(force.friction.x, force.friction.y, force.friction.z);
  contact.guess = 0.0;
  contact.friction_guess.setZero();
}

}  // namespace

std::string why_not_exchanged(const std::vector<Constraint*>& constraints) {
  for (const Constraint* constraint : constraints) {
    const auto* contact = constraint->find<ContactEffect>();
    const auto* self = constraint->find<SelfContactEffect>();
    if ((contact != nullptr && contact->is_wet()) || (self != nullptr && self->is_wet())) {
      return "effect 'wetness' is computed by the CPU only";
    }
    if (self != nullptr && self->most_particles() > DeviceContact::kParticles) {
      return "effect 'self_contact' of tetrahedra is computed by the CPU only; "
             "that of cloth and of particles is not";
    }
    const bool is_known =
        contact != nullptr || self != nullptr || constraint->find<FrictionEffect>() != nullptr;
    if (is_known) continue;
    return "effect '" + std::string(constraint->name()) + "' is computed by the CPU only";
  }
  return {};
}

void collect_contacts(const ProjectiveSystem& system, const Positions& predicted,
                      const std::vector<int>& place, ContactTable& table) {
  table.contacts.clear();
  table.embedded = false;
  collect_obstacles(system, predicted, place, table);
  collect_pairs(system, predicted, place, table);
  table.forces.assign(table.contacts.size(), {0.0f, {0.0f, 0.0f, 0.0f}});
  if (!table.contacts.empty()) table.index(system.particles.size());
}

void return_forces(const ContactTable& table, ProjectiveSystem& system) {
  const DeviceContactForce* next = table.forces.data();
  if (auto* effect = find_constraint<ContactEffect>(system.constraints)) {
    for (Contact& contact : effect->contacts()) {
      if (!effect->points().is_fixed(system.particles, contact.point)) take(*next++, contact);
    }
  }
  if (auto* effect = find_constraint<SelfContactEffect>(system.constraints)) {
    for (PairContact& contact : effect->contacts()) take(*next++, contact);
  }
}

}  // namespace pliant
