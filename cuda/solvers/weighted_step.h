#pragma once

#include "cuda/solvers/pull_step.h"

/// An iteration of WeightedJacobiSolver after PullStep, as functions of one thread: x += α d with
/// d = W γ D⁻¹ r.
namespace pliant {

/// d, from γ D⁻¹ r and its length.
PLIANT_HOST_DEVICE inline Float3 weighted(const SceneState& scene, const Float4& way) {
  const float mean = scene.control.mean_way, spread = scene.rules.spread;
  if (mean == 0.0f) return way.xyz();
  const float share = way.w / mean, least = 1.0f / spread;
  return (share < least ? least : (share > spread ? spread : share)) * way.xyz();
}

/// The mean length of γ D⁻¹ r; a block a scene.
struct MeanWay {
  using Sums = SceneSum<1>;
  static constexpr int kPhases = Sums::kPhases;
  StepArrays arrays;
  MatrixView matrix;
  const int* begins;  ///< first block of each scene, and the end

  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float* shared) const {
    const SceneState scene = arrays.scene(number);
    if (scene.control.done_at >= 0) return;
    auto* sums = reinterpret_cast<double*>(shared);
    Sums::add(phase, matrix.lengths, begins[number], begins[number + 1], thread, sums);
    if (phase != 2 || thread != 0) return;
    double length;
    Sums::total(sums, &length);
    scene.control.mean_way = static_cast<float>(length / scene.rules.particles);
  }
};

/// dᵀr and dᵀA d of each block.
struct WeightedProducts {
  static constexpr int kPhases = 3;
  using Sums = BlockSum<2>;
  StepArrays arrays;
  MatrixView matrix;

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const SceneState scene = arrays.scene_with(block);
    if (scene.control.done_at >= 0) return;
    if (phase == 1) Sums::first(shared, arrays.block, thread);
    if (phase == 2) Sums::second(shared, thread, matrix.products + 2 * block);
    if (phase != 0) return;
    float* sums = shared + 2 * thread;
    Sums::clear(sums);
    const int i = block * arrays.block + thread;
    const float mobility = i < arrays.particles ? arrays.mobility[i] : 0.0f;
    if (mobility == 0.0f) return;
    const Float4 way = matrix.way[i];
    const Float3 d = weighted(scene, way);
    sums[0] = dot(d, way.xyz()) / mobility;
    sums[1] = dot(d, product(scene, i, d));
  }

 private:
  /// (A d)_i = Σ_j A_ij d_i + Σ_j A_ij (d_j − d_i): differences keep the digits that matter where
  /// stiff neighbours move alike.
  PLIANT_HOST_DEVICE Float3 product(const SceneState& scene, int i, Float3 d) const {
    constexpr int kUnroll = SlicedRowsLayout::kUnroll, kSlice = SlicedRowsLayout::kSlice;
    Float3 sum = (arrays.predicted[i].w + matrix.held[i]) * d;
    if (matrix.rows.begins == nullptr) return sum;
    const int end = sliced_end(matrix.rows.begins, i);
    for (int k = sliced(matrix.rows.begins, i); k < end; k += kUnroll * kSlice) {
      Float4 other[kUnroll];
      for (int u = 0; u < kUnroll; ++u)
        other[u] = matrix.way[matrix.rows.neighbors[k + kSlice * u]];
      for (int u = 0; u < kUnroll; ++u) {
        sum += matrix.rows.b[k + kSlice * u] * (weighted(scene, other[u]) - d);
      }
    }
    return sum;
  }
};

/// α = dᵀr / dᵀA d; a block a scene.
struct BestStep {
  using Sums = SceneSum<2>;
  static constexpr int kPhases = Sums::kPhases;
  StepArrays arrays;
  MatrixView matrix;
  const int* begins;  ///< first block of each scene, and the end

  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float* shared) const {
    const SceneState scene = arrays.scene(number);
    if (scene.control.done_at >= 0) return;
    auto* sums = reinterpret_cast<double*>(shared);
    Sums::add(phase, matrix.products, begins[number], begins[number + 1], thread, sums);
    if (phase != 2 || thread != 0) return;
    double products[2];
    Sums::total(sums, products);
    scene.control.step = products[1] > 0.0 ? static_cast<float>(products[0] / products[1]) : 0.0f;
  }
};

/// x += α d.
struct LandWeighted {
  Acceleration iteration;
  MatrixView matrix;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const SceneState scene = iteration.arrays.scene_with(i / iteration.arrays.block);
    if (scene.control.done_at >= 0) return;
    const Float3 d = weighted(scene, matrix.way[i]);
    const Fixed* x = iteration.source(scene.control);
    land(iteration, scene, i, moved(x[i], (scene.control.step / scene.rules.quantum) * d));
  }
};

}  // namespace pliant
