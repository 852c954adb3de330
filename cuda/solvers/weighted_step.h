#pragma once

#include "cuda/solvers/gradient_step.h"

/// An iteration of LineSearchJacobiSolver after PullStep, as functions of one thread: x += α d with
/// d = W γ D⁻¹ r.
namespace pliant {

/// d, from γ D⁻¹ r and its length.
PLIANT_HOST_DEVICE inline Float3 weighted(const SceneState& scene, const Float4& correction) {
  const float mean = scene.control.mean_correction, spread = scene.rules.spread;
  if (mean == 0.0f) return correction.xyz();
  const float share = correction.w / mean, least = 1.0f / spread;
  return (share < least ? least : (share > spread ? spread : share)) * correction.xyz();
}

/// d of any place.
struct WeightedCorrections {
  const SceneState& scene;
  const Float4* correction;
  PLIANT_HOST_DEVICE const Float4& load(int i) const { return correction[i]; }
  PLIANT_HOST_DEVICE Float3 of(const Float4& loaded) const { return weighted(scene, loaded); }
};

/// Sums of `kCount` numbers a block over each scene's blocks, by a block a scene; then Result::take
/// puts them into the scene's state.
template <int kCount, class Result>
struct TotalsOfScenes {
  using Sums = SceneSum<kCount>;
  static constexpr int kPhases = Sums::kPhases;
  StepArrays arrays;
  const float* partial;
  const int* begins;  ///< first block of each scene, and the end

  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float* shared) const {
    const SceneState scene = arrays.scene(number);
    if (scene.control.done_at >= 0) return;
    auto* sums = reinterpret_cast<double*>(shared);
    Sums::add(phase, partial, begins[number], begins[number + 1], thread, sums);
    if (phase != 2 || thread != 0) return;
    double total[kCount];
    Sums::total(sums, total);
    Result::take(scene, total);
  }
};

/// The mean length of γ D⁻¹ r.
struct TakeMeanCorrection {
  PLIANT_HOST_DEVICE static void take(const SceneState& scene, const double* length) {
    scene.control.mean_correction = static_cast<float>(length[0] / scene.rules.particles);
  }
};
using MeanCorrection = TotalsOfScenes<1, TakeMeanCorrection>;

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
    const Float4 correction = matrix.correction[i];
    const Float3 d = weighted(scene, correction);
    sums[0] = dot(d, correction.xyz()) / mobility;
    sums[1] =
        dot(d, product_of_row(matrix, arrays, i, d, WeightedCorrections{scene, matrix.correction}));
  }
};

/// α = dᵀr / dᵀA d.
struct TakeBestStep {
  PLIANT_HOST_DEVICE static void take(const SceneState& scene, const double* products) {
    scene.control.step = products[1] > 0.0 ? static_cast<float>(products[0] / products[1]) : 0.0f;
  }
};
using BestStep = TotalsOfScenes<2, TakeBestStep>;

/// x += α d.
struct LandWeighted {
  Acceleration iteration;
  MatrixView matrix;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const SceneState scene = iteration.arrays.scene_with(i / iteration.arrays.block);
    if (scene.control.done_at >= 0) return;
    const Float3 d = weighted(scene, matrix.correction[i]);
    const Fixed* x = iteration.source(scene.control);
    land(iteration, scene, i, moved(x[i], (scene.control.step / scene.rules.quantum) * d));
  }
};

}  // namespace pliant
