#pragma once

#include "cuda/solvers/block_forces.h"
#include "cuda/solvers/sums.h"
#include "pliant/laws/coulomb.h"

/// One Jacobi iteration on a packed system, as functions of one thread: x += γ D⁻¹ r with r = M/h²
/// (y - x) + f(x), then contact, then Chebyshev's or Nesterov's step.
namespace pliant {

/// Contact and friction of a particle that shares its contacts with no other: out along each
/// normal, then the slip is cut by what the cones allow. `u` is the displacement from the
/// prediction [m]. Returns how many carry force.
PLIANT_HOST_DEVICE inline int touch(const ContactsView& view, int number, float mobility,
                                    Float3& u) {
  int active = 0;
  const int begin = view.begins[number], end = view.begins[number + 1];
  for (int k = begin; k < end; ++k) {
    const int c = view.entries[k] / 4;
    const Float4 plane = view.contacts[c].plane;
    const float gap = plane.w + dot(plane.xyz(), u);
    const float push = gap < 0.0f ? -gap : 0.0f;
    u += push * plane.xyz();
    view.forces[c] = {push / mobility, {0.0f, 0.0f, 0.0f}};
    if (push > 0.0f) ++active;
  }
  for (int k = begin; k < end && active > 0; ++k) {
    const int c = view.entries[k] / 4;
    const Float4 plane = view.contacts[c].plane, start = view.contacts[c].slip;
    const float bound = start.w * view.forces[c].normal;
    if (bound <= 0.0f) continue;
    Float3 slip = start.xyz() + u;
    slip -= dot(plane.xyz(), slip) * plane.xyz();
    const Float3 force = within_disk((-1.0f / mobility) * slip, bound);
    view.forces[c].friction = force;
    u += mobility * force;
  }
  return active;
}

/// Positions far outside the body would soon be too many quanta to count.
PLIANT_HOST_DEVICE inline bool is_in_range(const Fixed& x) {
  constexpr int kMost = 1 << 30;
  return x.x > -kMost && x.x < kMost && x.y > -kMost && x.y < kMost && x.z > -kMost && x.z < kMost;
}

/// Which iteration it is.
struct Turn {
  int from;   ///< which of the two x holds y; the other one takes the next
  int place;  ///< of the iteration in its interval
  bool measured;

  /// What is added to a displacement before it is rounded to quanta: each iteration of an interval
  /// adds another one of ±1/16, ±3/16 .. ±7/16, so that in their mean particles move by less than
  /// half a quantum too. Rounded to none over and over, such displacements would keep slow modes
  /// hundreds of quanta off.
  PLIANT_HOST_DEVICE Float3 dither() const {
    static_assert(kInterval == 8, "three bits");
    const int reversed = (place & 1) << 2 | (place & 2) | place >> 2;
    const float d = 0.125f * static_cast<float>(reversed) - 0.4375f;
    return {d, d, d};
  }
};

/// What an iteration reads and writes of a place, in the memory of all.
struct SharedPlaces {
  const StepArrays& arrays;
  int from;  ///< Turn

  PLIANT_HOST_DEVICE Fixed predicted(int i) const { return arrays.predicted[i]; }
  PLIANT_HOST_DEVICE float mobility(int i) const { return arrays.mobility[i]; }
  PLIANT_HOST_DEVICE Fixed previous(int i) const { return arrays.x[1 - from][i]; }
  PLIANT_HOST_DEVICE void set_next(int i, const Fixed& x) const { arrays.x[1 - from][i] = x; }
  PLIANT_HOST_DEVICE Fixed projected(int i) const { return arrays.projected[i]; }
  PLIANT_HOST_DEVICE void set_projected(int i, const Fixed& x) const { arrays.projected[i] = x; }
};

/// From J(y) to the next iterate.
struct Acceleration {
  StepArrays arrays;
  Turn turn;

  PLIANT_HOST_DEVICE static bool runs(const StepControl& control) { return control.done_at < 0; }
  /// y: the best state where the control went back to it.
  PLIANT_HOST_DEVICE const Fixed* source(const StepControl& control) const {
    return control.revert && turn.place == 0 ? arrays.saved[control.best] : arrays.x[turn.from];
  }

  /// `j` is J(y), to where forces moved it by `displacement` and contact by `push` [m]. Writes
  /// kMeasures numbers to `sums` if measured.
  PLIANT_HOST_DEVICE void operator()(const SceneState& scene, const Turn& of, int i, const Fixed& j,
                                     Float3 displacement, Float3 push, int active,
                                     float* sums) const {
    (*this)(scene, of, i, j, displacement, push, active, sums, SharedPlaces{arrays, of.from});
  }
  template <class Places>
  PLIANT_HOST_DEVICE void operator()(const SceneState& scene, const Turn& of, int i, const Fixed& j,
                                     Float3 displacement, Float3 push, int active, float* sums,
                                     const Places& places) const {
    const StepControl& control = scene.control;
    const float factor = control.factors[of.place];
    Fixed next = j, before = j;
    if (control.mode == StepControl::kMomentum) {
      before = places.projected(i);
      if (factor != 0.0f) next = moved(j, factor * (j - before));
      places.set_projected(i, j);
    } else if (factor != 1.0f) {
      const Fixed previous = places.previous(i);
      next = moved(previous, factor * (j - previous));
    }
    places.set_next(i, next);
    if (!of.measured) return;
    arrays.saved[1 - control.best][i] = j;
    if (control.mode != StepControl::kMomentum) places.set_projected(i, j);
    const float mobility = places.mobility(i);
    // D = γ / mobility; γ follows in the control kernel.
    const float d = mobility > 0.0f ? 1.0f / mobility : 0.0f;
    const Float3 change = displacement + push;
    sums[kChange] = is_in_range(next) ? d * dot(change, change) : HUGE_VALF;
    sums[kUphill] = -d * dot(change, scene.rules.quantum * (j - before));
    sums[kActive] = static_cast<float>(active);
    sums[kContact] = d * dot(push, push);
    sums[kPulled] = d * dot(displacement, displacement);
  }
};

/// The end of an iteration for one place, whose forces are known.
struct FinishIteration {
  ContactsView contacts;
  Acceleration accelerate;

  /// `r`: unbalanced force at `at`. Of a scene with contacts whose points share particles all up to
  /// these, with J(y) so far in raw and pushed.
  PLIANT_HOST_DEVICE void operator()(const SceneState& scene, const Turn& turn, int i,
                                     const Fixed& at, Float3 r, float* sums) const {
    (*this)(scene, turn, i, at, r, sums, SharedPlaces{accelerate.arrays, turn.from});
  }
  template <class Places>
  PLIANT_HOST_DEVICE void operator()(const SceneState& scene, const Turn& turn, int i,
                                     const Fixed& at, Float3 r, float* sums,
                                     const Places& places) const {
    const StepArrays& arrays = accelerate.arrays;
    const float quantum = scene.rules.quantum;
    const float mobility = scene.control.slow * places.mobility(i);
    const Float3 displacement = mobility * r;
    const Fixed raw = moved(at, (1.0f / quantum) * displacement + turn.dither());
    if (scene.rules.embedded) {
      arrays.raw[i] = arrays.pushed[i] = raw;
      return;
    }
    const int number = contacts.any && mobility > 0.0f ? contacts.first[i] : -1;
    if (number < 0) {
      accelerate(scene, turn, i, raw, displacement, {0.0f, 0.0f, 0.0f}, 0, sums, places);
      return;
    }
    const Float3 from = quantum * (raw - places.predicted(i));
    Float3 u = from;
    const int active = touch(contacts, number, mobility, u);
    const Float3 push = u - from;
    accelerate(scene, turn, i, moved(raw, (1.0f / quantum) * push), displacement, push, active,
               sums, places);
  }
};

/// A whole iteration.
struct Iterate {
  static constexpr int kMostThreads = BlockForces::kMostThreads;
  static constexpr int kLeastBlocks = BlockForces::kLeastBlocks;
  static constexpr int kForces = BlockForces::kPhases, kPhases = kForces + 3;
  using Sums = BlockSum<kMeasures>;
  BlockForces forces;
  FinishIteration finish;

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const Acceleration& accelerate = finish.accelerate;
    const StepArrays& arrays = accelerate.arrays;
    const SceneState scene = arrays.scene_with(block);
    if (scene.control.done_at >= 0) return;
    const bool measured = accelerate.turn.measured;
    float* sums = shared + forces.layout.before_sums();
    if (phase < kForces) {
      forces(phase, arrays, accelerate.source(scene.control), scene.rules.quantum, block, thread,
             shared);
    } else if (phase == kForces) {
      if (thread >= arrays.block) return;
      float* own = sums + thread * kMeasures;
      if (measured) Sums::clear(own);
      const int i = block * arrays.block + thread;
      if (i >= arrays.particles) return;
      const Float3 r = forces.unbalanced(arrays, i, block, scene.rules.quantum, shared);
      finish(scene, accelerate.turn, i, forces.layout.positions(shared)[thread], r, own);
    } else if (measured && !scene.rules.embedded) {
      if (phase == kForces + 1) Sums::first(sums, arrays.block, thread);
      if (phase == kForces + 2) Sums::second(sums, thread, arrays.partial + block * kMeasures);
    }
  }
};

}  // namespace pliant
