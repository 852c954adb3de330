#pragma once

#include "cuda/solvers/gradient_step.h"
#include "pliant/laws/length.h"
#include "pliant/solvers/device/device_iteration.h"

namespace pliant {

/// Numbers of L-BFGS beside the vectors, of one scene.
struct QuasiNewtonState {
  static constexpr int kMostSlots = DeviceIteration::kMostHistory + 1;
  static constexpr int kMostSweeps = DeviceIteration::kMostSweeps;

  // Weights of Chebyshev's sweeps z ← z + momentum (z − z₋) + pull γ D⁻¹ (q − A z).
  float momentum[kMostSweeps], pull[kMostSweeps];

  int iterations;  ///< so far in the step
  int held;        ///< pairs that shape the next direction
  int next;        ///< slot of the next pair; those before it hold the newest ones
  int is_retry;    ///< the next iteration takes a shorter step along the last direction
  int retries;
  int has_moved;  ///< since the last direction: there is a new pair
  int is_plain;   ///< the direction is that of no pairs
  int sweeps;     ///< Jacobi iterations after a correction, for contacts
  int sweeps_left;
  float step;            ///< α
  double least_balance;  ///< smallest norm of unbalanced forces so far in the step
  int least_at;          ///< iterations after which it was found
  /// s_i · y_j of slots.
  double products[kMostSlots][kMostSlots];
  float alpha[kMostSlots];  ///< of the first loop; 0 for a slot that is not used
  float share[kMostSlots];  ///< of s in the direction, likewise
};

/// Vectors of L-BFGS in the memory of an executor, of each place. `saved[best]` of the step's
/// arrays is where the step has come to, the other one what is tried, or what was before.
struct QuasiNewtonView {
  int history = 0;
  int sweeps = 0;
  int places = 0;
  float* partial = nullptr;            ///< sums of blocks
  Float4* forces[2] = {};              ///< r at saved[] [N]
  Float4* wanted = nullptr;            ///< q of the two loops [N], then the direction d [m]
  Float4* found[2] = {};               ///< z of the sweeps in turn [m]
  Float4* holds = nullptr;             ///< Hold of contacts
  Float4* s = nullptr;                 ///< slot after slot: moves [m]
  Float4* y = nullptr;                 ///< and what they changed of the forces, with minus [N]
  QuasiNewtonState* states = nullptr;  ///< one a scene

  PLIANT_HOST_DEVICE int slots() const { return history + 1; }
};

/// What contacts that carry force leave of a particle's freedom: nothing, a line, a plane or all.
struct Hold {
  enum Kind : int { kFree, kPlane, kLine, kFixed };

  /// w: the kind; of a plane its normal, of a line its direction.
  PLIANT_HOST_DEVICE static Float3 project(const Float4& hold, Float3 v) {
    const int kind = static_cast<int>(hold.w);
    if (kind == kFree) return v;
    if (kind == kFixed) return {0.0f, 0.0f, 0.0f};
    const Float3 along = dot(hold.xyz(), v) * hold.xyz();
    return kind == kLine ? along : v - along;
  }
  /// One more normal; those that lie almost within what is held already add nothing.
  PLIANT_HOST_DEVICE static Float4 with(const Float4& hold, Float3 normal) {
    constexpr float kIndependent = 0.1f;
    const Float3 rest = project(hold, normal);
    const float size = norm(rest);
    if (size <= kIndependent) return hold;
    const int kind = static_cast<int>(hold.w);
    if (kind == kFree) return with_w((1.0f / size) * rest, kPlane);
    if (kind == kLine) return {0.0f, 0.0f, 0.0f, kFixed};
    const Float3 line = cross(hold.xyz(), (1.0f / size) * rest);
    return with_w(line / divisor_of(line), kLine);
  }
};

/// Of place i.
PLIANT_HOST_DEVICE inline Float4 hold_of(const ContactsView& view, int i) {
  // Of a point's weights: a particle that hardly moves it is free.
  constexpr float kLeastWeight = 0.05f;
  Float4 hold = {0.0f, 0.0f, 0.0f, Hold::kFree};
  const int number = view.first[i];
  if (number < 0) return hold;
  for (int k = view.begins[number]; k < view.begins[number + 1]; ++k) {
    const int c = view.entries[k] / 4;
    const DeviceContactForce& force = view.forces[c];
    const float weight = (&view.contacts[c].weights.x)[view.entries[k] % 4];
    if (!(force.normal > 0.0f) || !(fabsf(weight) > kLeastWeight)) continue;
    const float bound = view.contacts[c].slip.w * force.normal;
    // Within the cone the point sticks.
    if (norm(force.friction) < bound) return {0.0f, 0.0f, 0.0f, Hold::kFixed};
    hold = Hold::with(hold, view.contacts[c].plane.xyz());
  }
  return hold;
}

}  // namespace pliant
