#pragma once

#include "cuda/solvers/resident_run/resident_step.h"

/// Sums over all particles in a resident run, in a fixed order.
namespace pliant {

struct ClearSums {
  float* sums;
  PLIANT_HOST_DEVICE void operator()(int k) const { sums[k] = 0.0f; }
};

/// Numbers that a reaction has: force and torque.
constexpr int kReactionNumbers = 6;

PLIANT_HOST_DEVICE inline void write_reaction(Float3 force, Float3 arm, float* to) {
  const Float3 torque = cross(arm, force);
  const float values[kReactionNumbers] = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
  for (int m = 0; m < kReactionNumbers; ++m) to[m] = values[m];
}

/// Adds a `share` of the `count` numbers that each thread of a block has in `shared`.
PLIANT_HOST_DEVICE inline void add_numbers(const float* shared, int count, int threads, int thread,
                                           float share, float* to) {
  for (int k = thread; k < count; k += threads) {
    float sum = 0.0f;
    for (int t = 0; t < threads; ++t) sum += shared[t * count + k];
    to[k] += share * sum;
  }
}

/// Adds a share of the force and torque of a block's particles on each obstacle, about its origin:
/// kReactionNumbers a slot.
struct SumReactions {
  static constexpr int kPhases = 2;
  StepArrays arrays;
  ResidentArrays resident;
  float share;
  float* sums;

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const int count = kReactionNumbers * resident.slots;
    if (phase == 0) {
      const int i = block * arrays.block + thread;
      for (int k = 0; k < count; ++k) shared[thread * count + k] = 0.0f;
      if (i < arrays.particles && resident.first[i] >= 0) write(i, shared + thread * count);
      return;
    }
    add_numbers(shared, count, arrays.block, thread, share, sums + block * count);
  }

 private:
  PLIANT_HOST_DEVICE void write(int i, float* to) const {
    const int number = scene_of(arrays, i);
    const Float3 at = place(resident.now[i], arrays.rules[number].quantum);
    for (int k = 0; k < resident.rules[number].obstacles; ++k) {
      const DeviceContactForce& f = resident.forces[resident.slots * i + k];
      const Float3 normal = resident.contacts[resident.slots * i + k].plane.xyz();
      const Float3 arm =
          at - resident.obstacles[resident.rules[number].first_obstacle + k].position;
      write_reaction(-1.0f * (f.normal * normal + f.friction), arm, to + kReactionNumbers * k);
    }
  }
};

/// The largest of all squared velocities: of runs of particles, then of these.
struct FindFastest {
  static constexpr int kPhases = 2;
  static constexpr int kThreads = 256;
  const Float4* velocity;
  int particles;
  float* of_runs;

  PLIANT_HOST_DEVICE void operator()(int phase, int run, int thread, float* shared) const {
    if (phase == 0) {
      const int i = run * kThreads + thread;
      const Float3 own = i < particles ? velocity[i].xyz() : Float3{0.0f, 0.0f, 0.0f};
      shared[thread] = dot(own, own);
    } else if (thread == 0) {
      of_runs[run] = largest(shared, kThreads);
    }
  }
  PLIANT_HOST_DEVICE static float largest(const float* values, int count) {
    float most = 0.0f;
    for (int k = 0; k < count; ++k) most = values[k] > most ? values[k] : most;
    return most;
  }
};

struct FindFastestOfRuns {
  static constexpr int kPhases = 2;
  static constexpr int kThreads = 256;
  const float* of_runs;
  int runs;
  ResidentTally* tally;

  PLIANT_HOST_DEVICE void operator()(int phase, int, int thread, float* shared) const {
    if (phase == 0) {
      float most = 0.0f;
      for (int k = thread; k < runs; k += kThreads) most = of_runs[k] > most ? of_runs[k] : most;
      shared[thread] = most;
    } else if (thread == 0) {
      tally->fastest = FindFastest::largest(shared, kThreads);
    }
  }
};

}  // namespace pliant
