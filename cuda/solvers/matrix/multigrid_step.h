#pragma once

#include "cuda/solvers/matrix/coarse_holds.h"
#include "cuda/solvers/matrix/packed_multigrid.h"
#include "cuda/solvers/matrix/quasi_newton_direction.h"

/// The V-cycle of Multigrid in place of A⁻¹ in L-BFGS, as functions of one thread. The finest level
/// is smoothed by SweepMatrix, where what contacts hold does not move; coarser ones are made
/// stiffer where they hold anything (coarse_holds.h). It is symmetric, and positive definite in the
/// directions that are free.
namespace pliant {

/// A MultigridPool in the memory of an executor, and vectors of its rows.
struct CoarseView {
  RowsView fine, matrix, restriction, prolongation;  ///< a is not used
  const float* diagonal = nullptr;
  const Float4* rule = nullptr;
  const int* scenes = nullptr;  ///< of slices; null: there is one
  const CycleBottom* bottoms = nullptr;
  bool has_holds = false;  ///< there are contacts
  Float4* held = nullptr;  ///< CoarseHold of each row, three a row
  Float4* q = nullptr;     ///< right-hand sides [N]
  Float4* z[2] = {};       ///< sweeps in turn [m]; residuals in the first, the result in the second

  PLIANT_HOST_DEVICE int number_of(int i) const {
    return scenes == nullptr ? 0 : scenes[i / SlicedRowsLayout::kSlice];
  }
};

/// Σ b v of row i.
template <int kUnroll>
PLIANT_HOST_DEVICE inline Float3 gathered(const RowsView& rows, int i, const Float4* v) {
  constexpr int kSlice = SlicedRowsLayout::kSlice;
  Float3 sum = {0.0f, 0.0f, 0.0f};
  const int end = sliced_end(rows.begins, i);
  for (int k = sliced(rows.begins, i); k < end; k += kUnroll * kSlice) {
    Float4 other[kUnroll];
    for (int u = 0; u < kUnroll; ++u) other[u] = v[rows.neighbors[k + kSlice * u]];
    for (int u = 0; u < kUnroll; ++u) sum += rows.b[k + kSlice * u] * other[u].xyz();
  }
  return sum;
}

/// What happens to row i of the pool.
struct CoarseRow {
  const CoarseView& view;
  int i;

  /// The right-hand side from the residuals of a finer level, and the first sweep.
  template <class Holds>
  PLIANT_HOST_DEVICE void restrict_from(const Float4* finer, const Holds& holds) const {
    const Float3 q = gathered<PackedMultigrid::kUnroll>(view.restriction, i, finer);
    view.q[i] = with_w(q, 0.0f);
    if (view.has_holds) gather_holds(holds);
    view.z[0][i] = with_w(view.rule[i].x * compliant(q), 0.0f);
    view.z[1][i] = {0.0f, 0.0f, 0.0f, 0.0f};
  }
  PLIANT_HOST_DEVICE void sweep(int k) const {
    const Float4 rule = view.rule[i];
    sweep(k, k == 0 ? 0.0f : rule.z, k == 0 ? rule.x : rule.y);
  }
  /// `pull` over the diagonal.
  PLIANT_HOST_DEVICE void sweep(int k, float momentum, float pull) const {
    const Float4* from = view.z[(k + 1) % 2];
    Float4& to = view.z[k % 2][i];
    const Float3 z = from[i].xyz();
    const Float3 left = view.q[i].xyz() - product(z, from);
    Float3 next = z + pull * compliant(left);
    if (momentum != 0.0f) next += momentum * (z - to.xyz());
    to = with_w(next, 0.0f);
  }
  PLIANT_HOST_DEVICE void residual() const {
    const Float4* z = view.z[1];
    view.z[0][i] = with_w(view.q[i].xyz() - product(z[i].xyz(), z), 0.0f);
  }
  PLIANT_HOST_DEVICE void prolong() const {
    constexpr int kUnroll = PackedMultigrid::kProlongUnroll;
    const Float3 more = gathered<kUnroll>(view.prolongation, i, view.z[1]);
    view.z[1][i] = with_w(view.z[1][i].xyz() + more, 0.0f);
  }

 private:
  template <class Holds>
  PLIANT_HOST_DEVICE void gather_holds(const Holds& holds) const {
    Symmetric3 sum = {};
    const int end = sliced_end(view.restriction.begins, i);
    for (int k = sliced(view.restriction.begins, i); k < end; k += SlicedRowsLayout::kSlice) {
      const float weight = view.restriction.b[k];
      if (weight != 0.0f) holds.add(view.restriction.neighbors[k], weight, sum);
    }
    CoarseHold::store(sum, view.diagonal[i], view.held + 3 * i);
  }
  /// D (D + K)⁻¹ v.
  PLIANT_HOST_DEVICE Float3 compliant(Float3 v) const {
    return view.has_holds ? CoarseHold::compliant(view.held + 3 * i, v) : v;
  }
  /// (A + K) z; as product_of_row().
  PLIANT_HOST_DEVICE Float3 product(Float3 own, const Float4* z) const {
    constexpr int kUnroll = PackedMultigrid::kUnroll, kSlice = SlicedRowsLayout::kSlice;
    const RowsView& rows = view.matrix;
    Float3 sum = view.rule[i].w * own;
    if (view.has_holds) sum += CoarseHold::stiffness(view.held + 3 * i).times(own);
    const int end = sliced_end(rows.begins, i);
    for (int k = sliced(rows.begins, i); k < end; k += kUnroll * kSlice) {
      Float4 other[kUnroll];
      for (int u = 0; u < kUnroll; ++u) other[u] = z[rows.neighbors[k + kSlice * u]];
      for (int u = 0; u < kUnroll; ++u) sum += rows.b[k + kSlice * u] * (other[u].xyz() - own);
    }
    return sum;
  }
};

/// The residual of the places after their first sweeps.
struct FineResidual {
  StepArrays arrays;
  MatrixView matrix;
  QuasiNewtonView view;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int number = arrays.number_of(i / arrays.block);
    if (!seeks(arrays.scene(number), view.states[number])) return;
    Float3 left = {0.0f, 0.0f, 0.0f};
    if (arrays.mobility[i] > 0.0f) {
      const Float4* z = view.found[1];
      left = view.wanted[i].xyz() -
             product_of_row(matrix, arrays, i, z[i].xyz(), SweepMatrix::Found{z});
      left = Hold::project(view.holds[i], left);
    }
    view.found[0][i] = with_w(left, 0.0f);
  }
};

/// What coarser levels found, for the places.
struct FineProlong {
  StepArrays arrays;
  QuasiNewtonView view;
  CoarseView coarse;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int number = arrays.number_of(i / arrays.block);
    if (arrays.mobility[i] == 0.0f || !seeks(arrays.scene(number), view.states[number])) return;
    constexpr int kUnroll = PackedMultigrid::kProlongUnroll;
    const Float3 more = gathered<kUnroll>(coarse.fine, i, coarse.z[1]);
    const Float3 z = view.found[1][i].xyz() + Hold::project(view.holds[i], more);
    view.found[1][i] = with_w(z, 0.0f);
  }
};

/// One of the things that happen to all rows of a launched level.
struct CoarseStep {
  enum What : int { kRestrictFine, kRestrict, kFirst, kSecond, kResidual, kProlong };
  StepArrays arrays;
  QuasiNewtonView view;
  CoarseView coarse;
  int begin;  ///< of the level
  What what;

  PLIANT_HOST_DEVICE void operator()(int k) const {
    const CoarseRow row = {coarse, begin + k};
    const int number = coarse.number_of(row.i);
    const SceneState scene = arrays.scene(number);
    if (!seeks(scene, view.states[number])) return;
    if (what == kRestrictFine) {
      row.restrict_from(view.found[0], HoldsOfPlaces{view.holds, arrays.mobility, scene.rules});
    }
    if (what == kRestrict) row.restrict_from(coarse.z[0], HoldsOfRows{coarse.held});
    if (what == kFirst) row.sweep(0);
    if (what == kSecond) row.sweep(1);
    if (what == kResidual) row.residual();
    if (what == kProlong) row.prolong();
  }
};

/// The cycle on the small levels, a block a scene: a launch would take longer than any of its
/// parts.
struct CoarseBottom {
  static constexpr int kThreads = 768;  // of 85 registers at the most
  static constexpr int kSmoothed = PackedMultigrid::kBlockLevels - 1;
  static constexpr int kDown = 3, kUp = 3;  // phases of a level
  static constexpr int kTurn = Multigrid::kCoarsestSweeps;
  static constexpr int kPhases = (kDown + kUp) * kSmoothed + kTurn;
  StepArrays arrays;
  QuasiNewtonView view;
  CoarseView coarse;

  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float* /*shared*/) const {
    if (!seeks(arrays.scene(number), view.states[number])) return;
    const CycleBottom& bottom = coarse.bottoms[number];
    const int smoothed = bottom.levels - (bottom.has_coarsest ? 1 : 0);
    constexpr int kFirst = kDown * kSmoothed, kSecond = kFirst + kTurn;
    if (phase < kFirst) {
      const int level = phase / kDown;
      if (level < smoothed) go_down(number, level, phase % kDown, thread);
    } else if (phase < kSecond) {
      if (bottom.has_coarsest) turn(number, smoothed, phase - kFirst, thread);
    } else {
      const int k = phase - kSecond, level = kSmoothed - 1 - k / kUp;
      if (level < smoothed) go_up(bottom, level, k % kUp, thread);
    }
  }

 private:
  PLIANT_HOST_DEVICE void begin(int number, int level, const CoarseRow& row) const {
    if (level == 0 && coarse.bottoms[number].is_fine) {
      const StepRules& rules = arrays.scene(number).rules;
      row.restrict_from(view.found[0], HoldsOfPlaces{view.holds, arrays.mobility, rules});
    } else {
      row.restrict_from(coarse.z[0], HoldsOfRows{coarse.held});
    }
  }
  PLIANT_HOST_DEVICE void go_down(int number, int level, int part, int thread) const {
    const CycleBottom& bottom = coarse.bottoms[number];
    for (int i = bottom.begin[level] + thread; i < bottom.end[level]; i += kThreads) {
      const CoarseRow row = {coarse, i};
      if (part == 0) begin(number, level, row);
      if (part == 1) row.sweep(1);
      if (part == 2) row.residual();
    }
  }
  PLIANT_HOST_DEVICE void go_up(const CycleBottom& bottom, int level, int part, int thread) const {
    if (part == 0 && level + 1 == bottom.levels) return;  // there is no coarser one
    for (int i = bottom.begin[level] + thread; i < bottom.end[level]; i += kThreads) {
      const CoarseRow row = {coarse, i};
      if (part == 0) row.prolong();
      if (part == 1) row.sweep(0);
      if (part == 2) row.sweep(1);
    }
  }
  /// Sweep k on the coarsest level.
  PLIANT_HOST_DEVICE void turn(int number, int level, int k, int thread) const {
    static_assert(Multigrid::kCoarsestSweeps % 2 == 0, "the last sweep ends where results are");
    const CycleBottom& bottom = coarse.bottoms[number];
    for (int i = bottom.begin[level] + thread; i < bottom.end[level]; i += kThreads) {
      const CoarseRow row = {coarse, i};
      if (k > 0) {
        row.sweep(k, bottom.momentum[k], bottom.pull[k] * coarse.rule[i].x);
      } else {
        begin(number, level, row);
        const Float3 z = coarse.z[0][i].xyz();
        coarse.z[0][i] = with_w(bottom.pull[0] * z, 0.0f);
      }
    }
  }
};

}  // namespace pliant
