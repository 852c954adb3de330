#pragma once

#include "cuda/solvers/iteration.h"

/// What iterations that read the matrix of projective dynamics begin and end with, as functions of
/// one thread.
namespace pliant {

/// A matrix (packed_matrix.h) and what iterations keep beside it, in the memory of an executor.
struct MatrixView {
  RowsView rows;                         ///< a is not used
  const float* held = nullptr;           ///< null: rows are not whole ones
  const int* members = nullptr;          ///< of sweeps
  const float* overflow_sums = nullptr;  ///< null: not a sweep
  /// Of each place the correction [m]: of weighted iterations γ D⁻¹ r and its length; in sweeps d.
  Float4* correction = nullptr;
  float* lengths = nullptr;   ///< Σ |γ D⁻¹ r| of each block [m]
  float* products = nullptr;  ///< dᵀr and dᵀA d of each block [J]
};

/// (A v)_i = Σ_j A_ij v_i + Σ_j A_ij (v_j − v_i), v_j = value(j) and v_i = `own`: differences keep
/// the digits that matter where stiff neighbours move alike.
template <class Value>
PLIANT_HOST_DEVICE inline Float3 product_of_row(const MatrixView& matrix, const StepArrays& arrays,
                                                int i, Float3 own, const Value& value) {
  constexpr int kUnroll = SlicedRowsLayout::kUnroll, kSlice = SlicedRowsLayout::kSlice;
  Float3 sum = (arrays.predicted[i].w + matrix.held[i]) * own;
  if (matrix.rows.begins == nullptr) return sum;
  const int end = sliced_end(matrix.rows.begins, i);
  for (int k = sliced(matrix.rows.begins, i); k < end; k += kUnroll * kSlice) {
    Float4 other[kUnroll];
    for (int u = 0; u < kUnroll; ++u) other[u] = value.load(matrix.rows.neighbors[k + kSlice * u]);
    for (int u = 0; u < kUnroll; ++u) {
      sum += matrix.rows.b[k + kSlice * u] * (value.of(other[u]) - own);
    }
  }
  return sum;
}

/// Forces that contacts put on place i, and how many count with it: those whose first corner it is.
PLIANT_HOST_DEVICE inline Float3 contact_force(const ContactsView& view, int i, int& active) {
  Float3 force = {0.0f, 0.0f, 0.0f};
  active = 0;
  const int number = view.any ? view.first[i] : -1;
  if (number < 0) return force;
  for (int k = view.begins[number]; k < view.begins[number + 1]; ++k) {
    const int c = view.entries[k] / 4, corner = view.entries[k] % 4;
    const DeviceContactForce& f = view.forces[c];
    const float weight = (&view.contacts[c].weights.x)[corner];
    force += weight * (f.normal * view.contacts[c].plane.xyz() + f.friction);
    if (corner == 0 && f.normal > 0.0f) ++active;
  }
  return force;
}

/// Unbalanced forces r at the iterate, times mobility, with those of contacts that are known so
/// far; measured: their norms.
struct PullStep {
  static constexpr int kMostThreads = BlockForces::kMostThreads;
  static constexpr int kLeastBlocks = BlockForces::kLeastBlocks;
  static constexpr int kForces = BlockForces::kPhases, kPhases = kForces + 3;
  static constexpr int kNumbers = kMeasures + 1;  ///< and the length of the correction
  using Sums = BlockSum<kNumbers>;

  BlockForces forces;
  ContactsView contacts;
  Acceleration accelerate;
  MatrixView matrix;

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const StepArrays& arrays = accelerate.arrays;
    const SceneState scene = arrays.scene_with(block);
    if (scene.control.done_at >= 0) return;
    float* sums = shared + forces.layout.before_sums();
    if (phase < kForces) {
      forces(phase, arrays, accelerate.source(scene.control), scene.rules.quantum, block, thread,
             shared);
    } else if (phase == kForces) {
      if (thread >= arrays.block) return;
      Sums::clear(sums + thread * kNumbers);
      const int i = block * arrays.block + thread;
      if (i < arrays.particles) pull(scene, i, block, shared, sums + thread * kNumbers);
    } else if (accelerate.turn.measured || matrix.lengths != nullptr) {
      if (phase == kForces + 1) Sums::first(sums, arrays.block, thread);
      if (phase == kForces + 2) tell(sums, block, thread);
    }
  }

 private:
  PLIANT_HOST_DEVICE void pull(const SceneState& scene, int i, int block, const float* shared,
                               float* sums) const {
    const StepArrays& arrays = accelerate.arrays;
    const float mobility = arrays.mobility[i];
    const Float3 r = forces.unbalanced(arrays, i, block, scene.rules.quantum, shared);
    int active;
    const Float3 contact = contact_force(contacts, i, active);
    const Float3 correction = mobility * (r + contact);
    const float length = norm(correction);
    matrix.correction[i] = with_w(correction, length);
    sums[kMeasures] = length;
    // Norms in that of 1/D. The overflow of a sweep has a mobility of 1 / (D + Σ |A_ij|).
    const float least = matrix.overflow_sums != nullptr ? matrix.overflow_sums[i] : 0.0f;
    const float inverse = mobility / (1.0f - mobility * least);
    sums[kChange] = inverse * dot(r + contact, r + contact);
    sums[kActive] = static_cast<float>(active);
    sums[kContact] = inverse * dot(contact, contact);
    sums[kPulled] = inverse * dot(r, r);
  }
  PLIANT_HOST_DEVICE void tell(const float* sums, int block, int thread) const {
    if (accelerate.turn.measured && thread < kMeasures) {
      accelerate.arrays.partial[block * kMeasures + thread] = Sums::of_parts(sums, thread);
    }
    if (matrix.lengths != nullptr && thread == kMeasures) {
      matrix.lengths[block] = Sums::of_parts(sums, kMeasures);
    }
  }
};

/// The iteration ends with place i at `next`.
PLIANT_HOST_DEVICE inline void land(const Acceleration& iteration, const SceneState& scene, int i,
                                    const Fixed& next) {
  const StepArrays& arrays = iteration.arrays;
  arrays.x[1 - iteration.turn.from][i] = next;
  if (!iteration.turn.measured) return;
  arrays.saved[1 - scene.control.best][i] = next;
  // All threads write the same number, and nobody reads it before they are done.
  if (!is_in_range(next)) arrays.partial[i / arrays.block * kMeasures + kChange] = HUGE_VALF;
}

}  // namespace pliant
