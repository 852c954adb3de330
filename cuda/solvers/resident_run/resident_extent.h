#pragma once

#include <cstddef>

#include "cuda/core/vector.h"

/// How far particles are from each other and how fast, where a state stays on the device.
namespace pliant {

/// Of some particles.
struct ResidentExtent {
  int low[3], high[3];  ///< [quanta]
  float fastest;        ///< largest coordinate of velocities times the time step [quanta]

  PLIANT_HOST_DEVICE void add(const ResidentExtent& other) {
    for (int k = 0; k < 3; ++k) {
      low[k] = other.low[k] < low[k] ? other.low[k] : low[k];
      high[k] = other.high[k] > high[k] ? other.high[k] : high[k];
    }
    fastest = other.fastest > fastest ? other.fastest : fastest;
  }
};

/// Of each run of kRun particles.
struct FindExtent {
  static constexpr int kPhases = 3;
  static constexpr int kThreads = 256, kEach = 8, kRun = kThreads * kEach;
  static constexpr int kFirst = 16;  ///< threads that add up the others'
  static constexpr int kFloats =
      kThreads * static_cast<int>(sizeof(ResidentExtent) / sizeof(float));
  const Fixed* x;
  const Float4* velocity;
  int particles;
  ResidentExtent* of_runs;

  PLIANT_HOST_DEVICE void operator()(int phase, int run, int thread, float* shared) const {
    auto* own = reinterpret_cast<ResidentExtent*>(shared);
    if (phase == 0) {
      const int first = run * kRun + thread;
      // Those after the last particle are what the run's first one is.
      own[thread] = of(first < particles ? first : run * kRun);
      for (int i = first + kThreads; i < (run + 1) * kRun && i < particles; i += kThreads) {
        own[thread].add(of(i));
      }
    } else if (phase == 1 && thread < kFirst) {
      for (int t = thread + kFirst; t < kThreads; t += kFirst) own[thread].add(own[t]);
    } else if (phase == 2 && thread == 0) {
      for (int t = 1; t < kFirst; ++t) own[0].add(own[t]);
      of_runs[run] = own[0];
    }
  }

 private:
  PLIANT_HOST_DEVICE ResidentExtent of(int i) const {
    const Fixed at = x[i];
    const Float4 v = velocity[i];
    const float across = fmaxf(fabsf(v.x), fabsf(v.y));
    return {{at.x, at.y, at.z}, {at.x, at.y, at.z}, fmaxf(across, fabsf(v.z))};
  }
};

}  // namespace pliant
