#pragma once

#include "cuda/solvers/resident_run/resident_sums.h"

/// What holds a part of a body together adds up to nothing: iterations that end early leave a
/// little of it unbalanced, which ViscoelasticModel takes away again, as here. With u the
/// displacement from the prediction to where they end, that is Σ m u / Σ m of the part.
namespace pliant {

/// Whether a contact carries force: then nothing is taken away.
struct FindPressing {
  ResidentArrays resident;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    if (resident.first[i] < 0) return;
    for (int k = 0; k < resident.slots; ++k) {
      if (resident.forces[resident.slots * i + k].normal != 0.0f) resident.tally->presses = 1;
    }
  }
};

/// Of one part, runs of particles: Σ (M/h²) u.
struct SumMissing {
  static constexpr int kPhases = 2;
  static constexpr int kThreads = 128;
  static constexpr int kNumbers = 3;
  static constexpr int kSharedFloats = 2 * kNumbers * kThreads;  // doubles
  ResidentArrays resident;
  int particles;
  const int* parts;  ///< of places; null: there is one
  int part;
  double* sums;  ///< kNumbers a run

  PLIANT_HOST_DEVICE void operator()(int phase, int run, int thread, float* shared) const {
    auto* own = reinterpret_cast<double*>(shared);
    if (phase == 0) {
      const int i = run * kThreads + thread;
      Float3 u = {0.0f, 0.0f, 0.0f};
      double weight = 0.0;
      if (i < particles && (parts == nullptr || parts[i] == part)) {
        u = resident.now[i] - resident.predicted[i];
        weight = static_cast<double>(resident.now[i].w);
      }
      own[kNumbers * thread] = weight * static_cast<double>(u.x);
      own[kNumbers * thread + 1] = weight * static_cast<double>(u.y);
      own[kNumbers * thread + 2] = weight * static_cast<double>(u.z);
    } else if (thread < kNumbers) {
      double sum = 0.0;
      for (int t = 0; t < kThreads; ++t) sum += own[kNumbers * t + thread];
      sums[kNumbers * run + thread] = sum;
    }
  }
};

/// Of all runs, over the part's weight.
struct MeanMissing {
  static constexpr int kPhases = 2;
  static constexpr int kThreads = SumMissing::kThreads;
  static constexpr int kNumbers = SumMissing::kNumbers;
  const double* sums;
  int runs;
  double weight;
  Float4* mean;

  PLIANT_HOST_DEVICE void operator()(int phase, int, int thread, float* shared) const {
    auto* own = reinterpret_cast<double*>(shared);
    if (phase == 0) {
      for (int k = 0; k < kNumbers; ++k) {
        double sum = 0.0;
        for (int run = thread; run < runs; run += kThreads) sum += sums[kNumbers * run + k];
        own[kNumbers * thread + k] = sum;
      }
    } else if (thread == 0) {
      double total[kNumbers] = {};
      for (int t = 0; t < kThreads; ++t) {
        for (int k = 0; k < kNumbers; ++k) total[k] += own[kNumbers * t + k];
      }
      *mean = {static_cast<float>(total[0] / weight), static_cast<float>(total[1] / weight),
               static_cast<float>(total[2] / weight), 0.0f};
    }
  }
};

struct TakeMissing {
  ResidentArrays resident;
  const int* parts;
  const Float4* means;  ///< of parts; 0 where one is held

  PLIANT_HOST_DEVICE void operator()(int i) const {
    if (resident.tally->presses != 0) return;
    const Float3 mean = means[parts == nullptr ? 0 : parts[i]].xyz();
    resident.now[i] = moved(resident.now[i], -1.0f * mean);
    const Float3 velocity =
        resident.velocity[i].xyz() - (1.0f - resident.rules->velocity_loss) * mean;
    resident.velocity[i] = with_w(velocity, 0.0f);
  }
};

}  // namespace pliant
