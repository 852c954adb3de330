#pragma once

#include "pliant/math/host_device.h"

/// Sums of `kCount` numbers a particle, in a fixed order, as functions of one thread.
namespace pliant {

/// Of a block's particles, which lie in `sums` one particle after the other: first by kParts
/// groups, then of these.
template <int kCount>
struct BlockSum {
  static constexpr int kParts = 8;

  PLIANT_HOST_DEVICE static void clear(float* sums) {
    for (int m = 0; m < kCount; ++m) sums[m] = 0.0f;
  }
  /// Into the first kParts places.
  PLIANT_HOST_DEVICE static void first(float* sums, int particles, int thread) {
    if (thread >= kParts * kCount) return;
    const int part = thread / kCount, number = thread % kCount;
    float sum = 0.0f;
    // Own place first: nobody else reads it.
    for (int k = part; k < particles; k += kParts) sum += sums[k * kCount + number];
    sums[part * kCount + number] = sum;
  }
  PLIANT_HOST_DEVICE static float of_parts(const float* sums, int number) {
    float sum = 0.0f;
    for (int part = 0; part < kParts; ++part) sum += sums[part * kCount + number];
    return sum;
  }
  /// `partial`: of the block.
  PLIANT_HOST_DEVICE static void second(const float* sums, int thread, float* partial) {
    if (thread < kCount) partial[thread] = of_parts(sums, thread);
  }
};

/// Of a scene's blocks, by a block of its own, in double precision: of threads, of kParts groups of
/// threads, of groups. At most kThreads / kParts numbers.
template <int kCount>
struct SceneSum {
  static constexpr int kPhases = 3;  ///< the third one may ask for the total
  static constexpr int kThreads = 256;
  static constexpr int kParts = 16;
  static constexpr int kSharedFloats = 2 * kThreads * kCount;

  PLIANT_HOST_DEVICE static void add(int phase, const float* partial, int begin, int end,
                                     int thread, double* sums) {
    if (phase == 0) {
      for (int m = 0; m < kCount; ++m) {
        double sum = 0.0;
        for (int b = begin + thread; b < end; b += kThreads) sum += partial[b * kCount + m];
        sums[thread * kCount + m] = sum;
      }
    } else if (phase == 1 && thread < kParts * kCount) {
      double sum = 0.0;
      for (int t = thread / kCount; t < kThreads; t += kParts) {
        sum += sums[t * kCount + thread % kCount];
      }
      sums[thread] = sum;
    }
  }
  PLIANT_HOST_DEVICE static void total(const double* sums, double* total) {
    for (int m = 0; m < kCount; ++m) total[m] = 0.0;
    for (int part = 0; part < kParts; ++part) {
      for (int m = 0; m < kCount; ++m) total[m] += sums[part * kCount + m];
    }
  }
};

/// As BlockSum, of a number of numbers that only the launch knows.
struct WideBlockSum {
  static constexpr int kParts = 8;
  int count;
  int threads;  ///< of the block, one a particle

  PLIANT_HOST_DEVICE void clear(float* sums) const {
    for (int m = 0; m < count; ++m) sums[m] = 0.0f;
  }
  PLIANT_HOST_DEVICE void first(float* sums, int thread) const {
    for (int t = thread; t < kParts * count; t += threads) {
      const int part = t / count, number = t % count;
      float sum = 0.0f;
      for (int k = part; k < threads; k += kParts) sum += sums[k * count + number];
      sums[t] = sum;
    }
  }
  PLIANT_HOST_DEVICE void second(const float* sums, int thread, float* partial) const {
    for (int number = thread; number < count; number += threads) {
      float sum = 0.0f;
      for (int part = 0; part < kParts; ++part) sum += sums[part * count + number];
      partial[number] = sum;
    }
  }
};

/// As SceneSum, likewise.
struct WideSceneSum {
  static constexpr int kPhases = 3;  ///< the third one finds the totals
  static constexpr int kThreads = 512;
  int count;

  PLIANT_HOST_DEVICE static constexpr int shared_floats(int count) {
    return 2 * (kThreads + count);
  }
  /// Memory of the totals.
  PLIANT_HOST_DEVICE static double* totals(double* sums) { return sums + kThreads; }
  PLIANT_HOST_DEVICE void add(int phase, const float* partial, int begin, int end, int thread,
                              double* sums) const {
    const int parts = kThreads / count;
    if (phase == 0 && thread < parts * count) {
      const int number = thread % count;
      double sum = 0.0;
      for (int b = begin + thread / count; b < end; b += parts) sum += partial[b * count + number];
      sums[thread] = sum;
    } else if (phase == 1 && thread < count) {
      double sum = 0.0;
      for (int part = 0; part < parts; ++part) sum += sums[part * count + thread];
      totals(sums)[thread] = sum;
    }
  }
};

}  // namespace pliant
