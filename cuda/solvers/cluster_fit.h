#pragma once

#include "cuda/solvers/iteration.h"

namespace pliant {

/// Fits small clusters to an iteration's positions, and sums chunks of the others: a thread each.
struct FitClusters {
  ClustersView clusters;
  Acceleration accelerate;

  PLIANT_HOST_DEVICE void operator()(int chunk) const {
    const StepArrays& arrays = accelerate.arrays;
    const int origin = clusters.origins[chunk];
    const SceneState scene = arrays.scene_with(origin / arrays.block);
    if (scene.control.done_at >= 0) return;
    const Fixed* x = accelerate.source(scene.control);
    const float quantum = scene.rules.quantum;
    const ClusterSums<float> sums = sum_members(clusters, x, chunk, quantum);
    if (chunk < clusters.small) {
      fit_cluster(clusters, x, origin, chunk, quantum, sums);
      return;
    }
    constexpr int kSize = ClusterSums<float>::kSize;
    float* to = clusters.sums + static_cast<std::size_t>(chunk - clusters.small) * kSize;
    for (int k = 0; k < kSize; ++k) to[k] = sums.v[k];
  }
};

/// Fits the others from the sums of their chunks, in a fixed order: a block each.
struct FitLargeClusters {
  static constexpr int kPhases = 3;
  static constexpr int kThreads = 128;
  static constexpr int kSize = ClusterSums<float>::kSize;
  static constexpr int kSharedFloats = 2 * kThreads * kSize;  // doubles
  ClustersView clusters;
  Acceleration accelerate;

  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float* shared) const {
    const StepArrays& arrays = accelerate.arrays;
    const int first = clusters.first_chunks[number], end = clusters.first_chunks[number + 1];
    const int origin = clusters.origins[first];
    const SceneState scene = arrays.scene_with(origin / arrays.block);
    if (scene.control.done_at >= 0) return;
    auto* sums = reinterpret_cast<double*>(shared);
    if (phase == 0) {
      ClusterSums<double> own;
      for (int chunk = first + thread; chunk < end; chunk += kThreads) {
        const float* from =
            clusters.sums + static_cast<std::size_t>(chunk - clusters.small) * kSize;
        for (int k = 0; k < kSize; ++k) own.v[k] += from[k];
      }
      for (int k = 0; k < kSize; ++k) sums[thread * kSize + k] = own.v[k];
    } else if (phase == 1 && thread < kSize) {
      double sum = 0.0;
      for (int t = 0; t < kThreads; ++t) sum += sums[t * kSize + thread];
      sums[thread] = sum;  // its own column: nobody else reads it
    } else if (phase == 2 && thread == 0) {
      ClusterSums<double> all;
      for (int k = 0; k < kSize; ++k) all.v[k] = sums[k];
      fit_cluster(clusters, accelerate.source(scene.control), origin, clusters.small + number,
                  scene.rules.quantum, all);
    }
  }
};

template <class Executor>
void launch_fits(Executor& executor, const ClustersView& clusters, const Acceleration& accelerate) {
  if (clusters.clusters == 0) return;
  executor.launch(clusters.chunks, FitClusters{clusters, accelerate});
  executor.launch_blocks(clusters.clusters - clusters.small, FitLargeClusters::kThreads,
                         FitLargeClusters::kSharedFloats, FitLargeClusters{clusters, accelerate});
}

}  // namespace pliant
