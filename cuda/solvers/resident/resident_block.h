#pragma once

#include "cuda/core/published.h"
#include "cuda/solvers/resident/kept_block.h"

namespace pliant {

/// What a block of IterateInRounds brings into shared memory: once a step its elements and its own
/// positions, in each iteration the positions at its border.
struct ResidentBlock {
  BlockForces forces;
  KeptPlaces at;
  FinishIteration finish;
  IterationPlan plan;

  PLIANT_HOST_DEVICE KeptBlock kept_in(float* shared) const { return {forces.layout, at, shared}; }
  /// Before the first iteration.
  PLIANT_HOST_DEVICE void keep(const BlockElements& of, int thread, float* shared) const {
    const ElementsView& all = of.all;
    const BlockShared& layout = forces.layout;
    const int p = of.pattern, slices = layout.block / SlicedRowsLayout::kSlice;
    BlockCounts n;
    n.tetrahedra = BlockCounts::count(all.tetrahedra.begins, p, 1);
    n.fibers = BlockCounts::count(all.fibers.begins, p, 1);
    n.triangles = BlockCounts::count(all.triangles.begins, p, 1);
    n.springs = BlockCounts::count(all.springs.begins, p, slices);
    n.cells = BlockCounts::count(all.cells.begins, p, slices);
    n.quadratic = BlockCounts::count(all.quadratic.begins, p, slices);
    const KeptBlock kept = kept_in(shared);
    if (thread == 0) {
      kept.counts() = n;
      kept.interval() = {0, plan.length(0), 0};
    }
    const StepArrays& arrays = finish.accelerate.arrays;
    const int number = arrays.number_of(of.block);
    copy(reinterpret_cast<const float*>(arrays.control + number),
         sizeof(StepControl) / sizeof(float), thread, shared + kept.at.control);
    copy(reinterpret_cast<const float*>(arrays.rules + number), sizeof(StepRules) / sizeof(float),
         thread, shared + kept.at.rules);
    const int first = of.block * layout.block;
    const int own =
        arrays.particles - first < layout.block ? arrays.particles - first : layout.block;
    copy(arrays.x[0] + first, own, thread, layout.positions(shared));
    copy(arrays.predicted + first, own, thread, kept.own(kept.at.predicted));
    copy(arrays.mobility + first, own, thread, shared + kept.at.mobility);
    if (all.slot_begins != nullptr) {
      copy(of.slot_begins(0), layout.block + 1, thread,
           reinterpret_cast<int*>(shared + kept.at.slot_begins));
    }
    if (all.borders.begins != nullptr) {
      const int begin = all.borders.begins[p];
      copy(all.borders.places + begin, all.borders.begins[p + 1] - begin, thread,
           reinterpret_cast<int*>(shared + kept.at.border));
    }
    keep(all.tetrahedra, n.tetrahedra, of, 3, thread, kept.tetrahedra());
    keep(all.fibers, n.fibers, of, 3, thread, kept.fibers());
    keep(all.triangles, n.triangles, of, 2, thread, kept.triangles());
    keep(all.springs, n.springs, of, thread, kept.springs());
    keep(all.cells, n.cells, of, thread, kept.cells());
    keep(all.quadratic, n.quadratic, of, thread, kept.quadratic());
  }
  /// Positions of the border, and where iterations go back to the best state those of the block.
  PLIANT_HOST_DEVICE void bring(const KeptBlock& kept, const BlockElements& of, int round,
                                int thread) const {
    const StepArrays& arrays = finish.accelerate.arrays;
    const StepControl& control = kept.scene().control;
    if (!control.revert || round != kept.interval().first) {
      const Fixed* x = arrays.x[round % 2];
      return bring_border(kept, of, thread, [&](int place) { return await(x + place, round); });
    }
    const Fixed* best = arrays.saved[control.best];
    const int first = of.block * forces.layout.block;
    Fixed* own = forces.layout.positions(kept.shared);
    for (int k = thread; k < forces.layout.block && first + k < arrays.particles;
         k += forces.threads) {
      own[k] = load_fresh(best + first + k);
    }
    bring_border(kept, of, thread, [&](int place) { return load_fresh(best + place); });
  }
  /// For the next step.
  PLIANT_HOST_DEVICE void save_rotations(const KeptBlock& kept, const BlockElements& of,
                                         int thread) const {
    if (at.most.tetrahedra == 0) return;
    const BlockSimplices own = kept.tetrahedra(), all = of.simplices(of.all.tetrahedra, 0);
    copy<PackedRotation>(own.rotations, own.end, thread, all.rotations + all.begin);
  }

 private:
  template <class T>
  PLIANT_HOST_DEVICE void copy(const T* from, int count, int thread, T* to) const {
    for (int k = thread; k < count; k += forces.threads) to[k] = from[k];
  }
  PLIANT_HOST_DEVICE void keep(const SimplicesView& view, int count, const BlockElements& of,
                               int quads, int thread, const BlockSimplices& to) const {
    if (count == 0) return;
    const BlockSimplices from = of.simplices(view, 0);
    for (int q = 0; q < quads; ++q) {
      copy(from.numbers + q * from.stride + from.begin, count, thread,
           const_cast<Float4*>(to.numbers) + q * to.stride);
    }
    copy(from.places + from.begin, count, thread, const_cast<UShort4*>(to.places));
    copy(from.slots + from.begin, count, thread, const_cast<UShort4*>(to.slots));
    if (from.rotations != nullptr) {
      copy<PackedRotation>(from.rotations + from.begin, count, thread, to.rotations);
    }
  }
  PLIANT_HOST_DEVICE void keep(const LocalRowsView& view, int count, const BlockElements& of,
                               int thread, const BlockRows& to) const {
    if (count == 0) return;
    const BlockRows from = of.rows(view);
    const int first = from.begins[0], slices = forces.layout.block / SlicedRowsLayout::kSlice;
    auto* begins = const_cast<int*>(to.begins);
    for (int k = thread; k <= slices; k += forces.threads) begins[k] = from.begins[k] - first;
    copy(from.neighbors + first, count, thread, const_cast<unsigned short*>(to.neighbors));
    if (to.a != nullptr) copy(from.a + first, count, thread, const_cast<float*>(to.a));
    copy(from.b + first, count, thread, const_cast<float*>(to.b));
  }

  template <class Position>
  PLIANT_HOST_DEVICE void bring_border(const KeptBlock& kept, const BlockElements& of, int thread,
                                       const Position& position) const {
    if (of.all.borders.begins == nullptr) return;
    Fixed* to = forces.layout.positions(kept.shared) + forces.layout.block;
    const int shift = (of.block - of.pattern) * forces.layout.block;
    const int* begins = of.all.borders.begins + of.pattern;
    const int* places = reinterpret_cast<const int*>(kept.shared + kept.at.border);
    const int count = begins[1] - begins[0];
    for (int k = thread; k < count; k += forces.threads) to[k] = position(shift + places[k]);
  }
};

}  // namespace pliant
