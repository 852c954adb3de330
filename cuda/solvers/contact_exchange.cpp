#include "cuda/solvers/contact_exchange.h"

#include "pliant/effects/contact.h"
#include "pliant/effects/friction.h"

namespace pliant {
namespace {

template <class Wanted>
Wanted* find(const std::vector<Coupling*>& couplings) {
  for (Coupling* coupling : couplings) {
    if (auto* found = dynamic_cast<Wanted*>(coupling)) return found;
  }
  return nullptr;
}

Float4 packed(const Eigen::Vector3d& v, double w) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
          static_cast<float>(w)};
}

void set_particles(const ContactEffect& effect, int point, const CarriedPoints* carried,
                   const std::vector<int>& place, DeviceContact& contact) {
  const auto at = [&](int particle) { return place[static_cast<std::size_t>(particle)]; };
  if (!effect.points().are_carried()) {
    contact.particles = {{at(point), -1, -1, -1}};
    contact.weights = {1.0f, 0.0f, 0.0f, 0.0f};
    return;
  }
  const auto w = carried->weights().col(point).cast<float>().eval();
  for (int a = 0; a < 4; ++a) contact.particles.v[a] = at(carried->particles()(a, point));
  contact.weights = {w[0], w[1], w[2], w[3]};
}

}  // namespace

std::string why_not_exchanged(const std::vector<Coupling*>& couplings) {
  for (const Coupling* coupling : couplings) {
    const auto* contact = dynamic_cast<const ContactEffect*>(coupling);
    if (contact != nullptr && contact->is_wet()) {
      return "effect 'wetness' is computed by the CPU only";
    }
    if (contact != nullptr || dynamic_cast<const FrictionEffect*>(coupling) != nullptr) continue;
    return "effect '" + std::string(coupling->name()) + "' is computed by the CPU only";
  }
  return {};
}

void collect_contacts(const ProjectiveSystem& system, const Positions& predicted,
                      const std::vector<int>& place, ContactTable& table) {
  table.contacts.clear();
  table.forces.clear();
  const auto* effect = find<ContactEffect>(system.couplings);
  if (effect == nullptr) return;
  const auto* friction = find<FrictionEffect>(system.couplings);
  const Particles& particles = system.particles;
  table.carried = effect->points().are_carried();
  for (const Contact& contact : effect->contacts()) {
    if (effect->points().is_fixed(particles, contact.point)) continue;
    DeviceContact packed_contact;
    set_particles(*effect, contact.point, effect->points().carried(), place, packed_contact);
    const Eigen::Vector3d at = effect->points().position(predicted, contact.point);
    packed_contact.plane = packed(contact.normal, contact.normal.dot(at) - contact.plane);
    const Eigen::Vector3d stuck =
        effect->points().position(particles.x_start, contact.point) + contact.surface_motion;
    packed_contact.slip = packed(at - stuck, friction ? friction->coefficient(contact) : 0.0);
    table.contacts.push_back(packed_contact);
    table.forces.push_back({0.0f, {0.0f, 0.0f, 0.0f}});
  }
  if (!table.contacts.empty()) table.index(particles.size());
}

void return_forces(const ContactTable& table, ProjectiveSystem& system) {
  auto* effect = find<ContactEffect>(system.couplings);
  if (effect == nullptr) return;
  std::size_t next = 0;
  for (Contact& contact : effect->contacts()) {
    if (effect->points().is_fixed(system.particles, contact.point)) continue;
    const DeviceContactForce& force = table.forces[next++];
    contact.normal_force = force.normal;
    contact.friction_force = Eigen::Vector3d(force.friction.x, force.friction.y, force.friction.z);
    contact.guess = 0.0;
    contact.friction_guess.setZero();
  }
}

}  // namespace pliant
