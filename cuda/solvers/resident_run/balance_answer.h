#pragma once

#include "cuda/solvers/resident_run/balance_components.h"
#include "pliant/laws/coulomb.h"

namespace pliant {

/// What a contact answers to a motion of its component:
///   λ = Π(λ0 − (g + u)/C),
/// with its gap and slip g, how its particle moves u, its compliance C and the projection Π onto
/// Coulomb's cone.
struct AnsweredContact {
  Double3 normal, moved, slip, arm, uncut;
  double compliance, normal_force, bound;

  PLIANT_HOST_DEVICE bool slides() const { return norm(uncut) > bound; }
  PLIANT_HOST_DEVICE Double3 friction() const { return within_disk(uncut, bound); }
  /// Whose gradient the force is, where the bound of friction is given [N m].
  PLIANT_HOST_DEVICE double potential() const {
    const double size = norm(uncut), cut = greater(0.0, size - bound);
    return 0.5 * compliance * (normal_force * normal_force + size * size - cut * cut);
  }
};

/// The contacts of a component's members, each at `slot`.
struct BalanceContacts {
  /// Gap of an obstacle that is not near.
  static constexpr float kFar = 1e29f;

  StepArrays arrays;
  ResidentArrays resident;
  BalanceComponents components;
  const Fixed* x;  ///< where the particles are
  float softness;  ///< compliance as a share of a particle's own answer to a force

  /// Does `each`(slot) for the contacts of a particle.
  template <class Each>
  PLIANT_HOST_DEVICE void for_each(int i, const Each& each) const {
    if (resident.slots == 0 || resident.first[i] < 0) return;
    const int obstacles = resident.rules[scene_of(arrays, i)].obstacles;
    for (int k = 0; k < obstacles; ++k) {
      const int slot = resident.slots * i + k;
      if (resident.contacts[slot].plane.w < kFar) each(slot);
    }
  }
  PLIANT_HOST_DEVICE AnsweredContact answered(const BalanceMotion& motion, int i, int slot) const {
    const DeviceContact& contact = resident.contacts[slot];
    const DeviceContactForce& kept = resident.forces[slot];
    const Float4 row = components.rows[slot];
    AnsweredContact a;
    a.arm = motion.arm(x[i], arrays.rules[scene_of(arrays, i)].quantum);
    a.normal = in_double(contact.plane.xyz());
    a.moved = motion.of(a.arm);
    a.compliance = softness * static_cast<double>(arrays.mobility[i]);
    const double along = dot(a.normal, a.moved);
    a.normal_force = greater(0.0, kept.normal - (row.w + along) / a.compliance);
    a.slip = in_double(row.xyz()) + (a.moved - along * a.normal);
    a.uncut = in_double(kept.friction) - (1.0 / a.compliance) * a.slip;
    a.bound = contact.slip.w * a.normal_force;
    return a;
  }
  /// Gives a particle's contacts the forces with which they answer, and what they become.
  PLIANT_HOST_DEVICE void take(const BalanceMotion& motion, int i) const {
    for_each(i, [&](int slot) {
      const AnsweredContact a = answered(motion, i, slot);
      const double along = dot(a.normal, a.moved);
      components.rows[slot] =
          with_w(in_single(a.slip), components.rows[slot].w + static_cast<float>(along));
      resident.forces[slot] = {static_cast<float>(a.normal_force), in_single(a.friction())};
    });
  }
};

/// Of all contacts of a component.
struct ContactAnswer {
  double force[6];   ///< and torque about the component's centre [N, N m]
  double size;       ///< Σ |force| [N]
  double saved;      ///< work of friction, by the slips that the motion takes back [N m]
  double potential;  ///< where bounds of friction are given [N m]
  double shape[36];  ///< how force and torque fall with the motion, row by row

  /// `follows`: how much the bound of friction follows the normal force; 0: it is given.
  PLIANT_HOST_DEVICE void add(const AnsweredContact& a, double slip_at_start, double follows) {
    const Double3 friction = a.friction(), pushed = a.normal_force * a.normal + friction;
    const Double3 torque = cross(a.arm, pushed);
    const double values[6] = {pushed.x, pushed.y, pushed.z, torque.x, torque.y, torque.z};
    for (int k = 0; k < 6; ++k) force[k] += values[k];
    size += a.normal_force + norm(friction);
    saved += a.bound * (slip_at_start - norm(a.slip));
    potential += a.potential();
    add_shape(a, follows);
  }

 private:
  /// −Jᵀ ∂λ/∂u J.
  PLIANT_HOST_DEVICE void add_shape(const AnsweredContact& a, double follows) {
    const double n[3] = {a.normal.x, a.normal.y, a.normal.z};
    const double stiff = 1.0 / a.compliance, length = norm(a.uncut);
    const Double3 direction = length > 0.0 ? a.uncut / length : Double3{0.0, 0.0, 0.0};
    const double d[3] = {direction.x, direction.y, direction.z};
    const bool slides = a.slides();
    const double across = slides ? stiff * a.bound / length : stiff;
    const double along = a.normal_force > 0.0 ? stiff : 0.0;
    const double coupled = slides && a.normal_force > 0.0 ? follows * stiff : 0.0;
    // u = shift + turn × arm = (1, r) z.
    const double r[3][3] = {
        {0.0, a.arm.z, -a.arm.y}, {-a.arm.z, 0.0, a.arm.x}, {a.arm.y, -a.arm.x, 0.0}};
    double k[3][3], kr[3][3];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const double plane = (i == j ? 1.0 : 0.0) - n[i] * n[j] - (slides ? d[i] * d[j] : 0.0);
        k[i][j] = along * n[i] * n[j] + across * plane + coupled * d[i] * n[j];
      }
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        kr[i][j] = k[i][0] * r[0][j] + k[i][1] * r[1][j] + k[i][2] * r[2][j];
      }
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        shape[6 * i + j] += k[i][j];
        shape[6 * i + 3 + j] += kr[i][j];
        shape[6 * (3 + i) + j] += r[0][i] * k[0][j] + r[1][i] * k[1][j] + r[2][i] * k[2][j];
        shape[6 * (3 + i) + 3 + j] += r[0][i] * kr[0][j] + r[1][i] * kr[1][j] + r[2][i] * kr[2][j];
      }
    }
  }
};

}  // namespace pliant
