#pragma once

#include "cuda/solvers/iteration.h"

/// What an iteration does where contact points share particles.
namespace pliant {

/// Contacts of points that share particles: sweeps over those of a scene by one block. Each gives
/// its particles the part of the correction that they would need alone, over the number of contacts
/// that move each of them (mass splitting, Tonge et al. 2012): then all together never overshoot.
struct CarriedContacts {
  static constexpr int kSweeps = 6;
  static constexpr int kPhases = 2 * kSweeps + 1;
  StepArrays arrays;
  ContactsView view;
  int threads;  ///< that share the contacts of a scene

  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float*) const {
    const SceneState scene = arrays.scene(number);
    if (scene.control.done_at >= 0 || scene.control.rests || !scene.rules.embedded) return;
    // Contacts at even places, particles at odd ones.
    const int* begins = view.begins_of_scenes + 2 * number + (phase % 2 == 0 ? 1 : 0);
    for (int k = begins[0] + thread; k < begins[2]; k += threads) {
      if (phase % 2 == 0) {
        move(scene, k);
      } else {
        correct(scene, k);
      }
    }
  }

 private:
  /// The particle to where all forces put it.
  PLIANT_HOST_DEVICE void move(const SceneState& scene, int n) const {
    const int i = view.touched[n];
    Float3 force = {0.0f, 0.0f, 0.0f};
    for (int k = view.begins[n]; k < view.begins[n + 1]; ++k) {
      const int c = view.entries[k] / 4;
      const float weight = (&view.contacts[c].weights.x)[view.entries[k] % 4];
      const DeviceContactForce& f = view.forces[c];
      force += weight * (f.normal * view.contacts[c].plane.xyz() + f.friction);
    }
    const float mobility = scene.control.slow * arrays.mobility[i] / scene.rules.quantum;
    arrays.pushed[i] = moved(arrays.raw[i], mobility * force);
  }

  PLIANT_HOST_DEVICE void correct(const SceneState& scene, int c) const {
    const DeviceContact& contact = view.contacts[c];
    Float3 u = {0.0f, 0.0f, 0.0f};
    float own = 0.0f;
    for (int a = 0; a < 4 && contact.particles.v[a] >= 0; ++a) {
      const int i = contact.particles.v[a];
      const float weight = (&contact.weights.x)[a];
      const int n = view.first[i];
      const auto shares = static_cast<float>(view.begins[n + 1] - view.begins[n]);
      u += (weight * scene.rules.quantum) * (arrays.pushed[i] - arrays.predicted[i]);
      own += weight * weight * shares * scene.control.slow * arrays.mobility[i];
    }
    if (own == 0.0f) return;
    DeviceContactForce& f = view.forces[c];
    const Float3 normal = contact.plane.xyz();
    const float gap = contact.plane.w + dot(normal, u);
    const float wanted = f.normal - gap / own;
    f.normal = wanted > 0.0f ? wanted : 0.0f;
    Float3 slip = contact.slip.xyz() + u;
    slip -= dot(normal, slip) * normal;
    f.friction = within_disk(f.friction - (1.0f / own) * slip, contact.slip.w * f.normal);
  }
};

/// One phase of CarriedContacts of a single scene with many contacts, by all blocks.
struct SpreadContacts {
  static constexpr int kPhases = 1;
  CarriedContacts all;
  int phase, block_size;

  PLIANT_HOST_DEVICE void operator()(int, int block, int thread, float* shared) const {
    all(phase, 0, block * block_size + thread, shared);
  }
};

/// The rest of an iteration with contacts of embedded points.
struct AccelerateCarried {
  static constexpr int kPhases = 3;
  Acceleration accelerate;
  ContactsView view;

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const StepArrays& arrays = accelerate.arrays;
    const SceneState scene = arrays.scene_with(block);
    if (scene.control.done_at >= 0 || !scene.rules.embedded) return;
    if (phase == 0) {
      float* sums = shared + thread * kMeasures;
      if (accelerate.turn.measured) Sums::clear(sums);
      const int i = block * arrays.block + thread;
      if (i >= arrays.particles) return;
      const float quantum = scene.rules.quantum;
      const Fixed raw = arrays.raw[i], j = arrays.pushed[i];
      accelerate(scene, accelerate.turn, i, j,
                 quantum * (raw - accelerate.source(scene.control)[i]), quantum * (j - raw),
                 active(i), sums);
    } else if (accelerate.turn.measured) {
      if (phase == 1) Sums::first(shared, arrays.block, thread);
      if (phase == 2) Sums::second(shared, thread, arrays.partial + block * kMeasures);
    }
  }

 private:
  using Sums = BlockSum<kMeasures>;

  /// Contacts that count with particle i: those whose first corner it is.
  PLIANT_HOST_DEVICE int active(int i) const {
    const int n = view.first[i];
    if (!accelerate.turn.measured || n < 0) return 0;
    int count = 0;
    for (int k = view.begins[n]; k < view.begins[n + 1]; ++k) {
      if (view.entries[k] % 4 == 0 && view.forces[view.entries[k] / 4].normal > 0.0f) ++count;
    }
    return count;
  }
};

}  // namespace pliant
