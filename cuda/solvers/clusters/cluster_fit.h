#pragma once

#include "cuda/solvers/iteration.h"

namespace pliant {

/// Fits small clusters to the positions that an `Iteration` (Acceleration or another that has what
/// is used here) asks forces for, and sums chunks of the others: a thread each.
template <class Iteration>
struct FitClusters {
  ClustersView clusters;
  Iteration iteration;

  PLIANT_HOST_DEVICE void operator()(int chunk) const {
    const StepArrays& arrays = iteration.arrays;
    const int origin = clusters.origins[chunk];
    const SceneState scene = arrays.scene_with(origin / arrays.block);
    if (!iteration.runs(scene.control)) return;
    const Fixed* x = iteration.source(scene.control);
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
template <class Iteration>
struct FitLargeClusters {
  static constexpr int kPhases = 3;
  static constexpr int kThreads = 128;
  static constexpr int kSize = ClusterSums<float>::kSize;
  static constexpr int kSharedFloats = 2 * kThreads * kSize;  // doubles
  ClustersView clusters;
  Iteration iteration;

  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float* shared) const {
    const StepArrays& arrays = iteration.arrays;
    const int first = clusters.first_chunks[number], end = clusters.first_chunks[number + 1];
    const int origin = clusters.origins[first];
    const SceneState scene = arrays.scene_with(origin / arrays.block);
    if (!iteration.runs(scene.control)) return;
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
      fit_cluster(clusters, iteration.source(scene.control), origin, clusters.small + number,
                  scene.rules.quantum, all);
    }
  }
};

template <class Executor, class Iteration>
void launch_fits(Executor& executor, const ClustersView& clusters, const Iteration& iteration) {
  if (clusters.clusters == 0) return;
  using Large = FitLargeClusters<Iteration>;
  executor.launch(clusters.chunks, FitClusters<Iteration>{clusters, iteration});
  executor.launch_blocks(clusters.clusters - clusters.small, Large::kThreads, Large::kSharedFloats,
                         Large{clusters, iteration});
}

}  // namespace pliant
