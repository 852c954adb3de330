#pragma once

#include "cuda/core/mailbox.h"
#include "cuda/solvers/blocks/shared_memory_block.h"

namespace pliant {

/// What a block of PersistentIteration brings into shared memory: once a step its elements and its
/// own positions, in each iteration the positions at its border.
struct SharedMemoryLoad {
  BlockForces forces;
  SharedMemoryPlaces at;
  FinishIteration finish;
  IterationPlan plan;

  PLIANT_HOST_DEVICE SharedMemoryBlock memory_of(float* shared) const {
    return {forces.layout, at, shared};
  }
  /// Elements and own positions, before the first iteration.
  PLIANT_HOST_DEVICE void load(const BlockElements& of, int thread, float* shared) const {
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
    const SharedMemoryBlock memory = memory_of(shared);
    if (thread == 0) {
      memory.counts() = n;
      memory.interval() = {0, plan.length(0), 0};
    }
    const StepArrays& arrays = finish.accelerate.arrays;
    const int number = arrays.number_of(of.block);
    copy(reinterpret_cast<const float*>(arrays.control + number),
         sizeof(StepControl) / sizeof(float), thread, shared + memory.at.control);
    copy(reinterpret_cast<const float*>(arrays.rules + number), sizeof(StepRules) / sizeof(float),
         thread, shared + memory.at.rules);
    const int first = of.block * layout.block;
    const int own =
        arrays.particles - first < layout.block ? arrays.particles - first : layout.block;
    copy(arrays.x[0] + first, own, thread, layout.positions(shared));
    copy(arrays.predicted + first, own, thread, memory.own(memory.at.predicted));
    copy(arrays.mobility + first, own, thread, shared + memory.at.mobility);
    if (all.slot_begins != nullptr) {
      copy(of.slot_begins(0), layout.block + 1, thread,
           reinterpret_cast<int*>(shared + memory.at.slot_begins));
    }
    if (all.borders.begins != nullptr) {
      const int begin = all.borders.begins[p];
      copy(all.borders.places + begin, all.borders.begins[p + 1] - begin, thread,
           reinterpret_cast<int*>(shared + memory.at.border));
    }
    load(all.tetrahedra, n.tetrahedra, of, 3, thread, memory.tetrahedra());
    load(all.fibers, n.fibers, of, 3, thread, memory.fibers());
    load(all.triangles, n.triangles, of, 2, thread, memory.triangles());
    load(all.springs, n.springs, of, thread, memory.springs());
    load(all.cells, n.cells, of, thread, memory.cells());
    load(all.quadratic, n.quadratic, of, thread, memory.quadratic());
  }
  /// Positions of the border, and where iterations go back to the best state those of the block.
  PLIANT_HOST_DEVICE void read_positions(const SharedMemoryBlock& memory, const BlockElements& of,
                                         int iteration, int thread) const {
    const StepArrays& arrays = finish.accelerate.arrays;
    const StepControl& control = memory.scene().control;
    if (!control.revert || iteration != memory.interval().first) {
      const Fixed* x = arrays.x[iteration % 2];
      return read_border(memory, of, thread,
                         [&](int place) { return await(x + place, iteration); });
    }
    const Fixed* best = arrays.saved[control.best];
    const int first = of.block * forces.layout.block;
    Fixed* own = forces.layout.positions(memory.shared);
    for (int k = thread; k < forces.layout.block && first + k < arrays.particles;
         k += forces.threads) {
      own[k] = load_fresh(best + first + k);
    }
    read_border(memory, of, thread, [&](int place) { return load_fresh(best + place); });
  }
  /// For the next step.
  PLIANT_HOST_DEVICE void save_rotations(const SharedMemoryBlock& memory, const BlockElements& of,
                                         int thread) const {
    if (at.most.tetrahedra == 0) return;
    const BlockSimplices own = memory.tetrahedra(), all = of.simplices(of.all.tetrahedra, 0);
    copy<PackedRotation>(own.rotations, own.end, thread, all.rotations + all.begin);
  }

 private:
  template <class T>
  PLIANT_HOST_DEVICE void copy(const T* from, int count, int thread, T* to) const {
    for (int k = thread; k < count; k += forces.threads) to[k] = from[k];
  }
  PLIANT_HOST_DEVICE void load(const SimplicesView& view, int count, const BlockElements& of,
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
  PLIANT_HOST_DEVICE void load(const LocalRowsView& view, int count, const BlockElements& of,
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
  PLIANT_HOST_DEVICE void read_border(const SharedMemoryBlock& memory, const BlockElements& of,
                                      int thread, const Position& position) const {
    if (of.all.borders.begins == nullptr) return;
    Fixed* to = forces.layout.positions(memory.shared) + forces.layout.block;
    const int shift = (of.block - of.pattern) * forces.layout.block;
    const int* begins = of.all.borders.begins + of.pattern;
    const int* places = reinterpret_cast<const int*>(memory.shared + memory.at.border);
    const int count = begins[1] - begins[0];
    for (int k = thread; k < count; k += forces.threads) to[k] = position(shift + places[k]);
  }
};

}  // namespace pliant
