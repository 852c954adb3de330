#pragma once

#include "cuda/solvers/iteration.h"

/// Iterations on end of a body so small that all of its blocks run at the same time: each keeps
/// what it reads of its elements in shared memory, and between two iterations positions alone go
/// through the memory of all.
namespace pliant {

/// How many simplices and entries of rows a block has.
struct BlockCounts {
  int tetrahedra = 0, fibers = 0, triangles = 0, springs = 0, quadratic = 0;

  /// `begins_of`: of blocks, or null.
  PLIANT_HOST_DEVICE static int count(const int* begins, int block, int stride) {
    return begins == nullptr ? 0 : begins[(block + 1) * stride] - begins[block * stride];
  }
};

/// Where in shared memory, behind BlockShared, a block of so many elements keeps what.
struct KeptPlaces {
  int control, rules, counts, slot_begins, border;
  int tetrahedra, fibers, triangles, springs, quadratic;
  int end;

  PLIANT_HOST_DEVICE KeptPlaces(const BlockShared& layout, const BlockCounts& n, int floats) {
    end = floats;
    const int slices = layout.block / SlicedRowsLayout::kSlice + 1;
    control = take(static_cast<int>(sizeof(StepControl) / sizeof(float)));
    rules = take(static_cast<int>(sizeof(StepRules) / sizeof(float)));
    counts = take(static_cast<int>(sizeof(BlockCounts) / sizeof(float)));
    slot_begins = take(layout.block + 1);
    border = take(layout.border);
    // Numbers, places, slots; of tetrahedra the rotations as well.
    tetrahedra = take(18 * n.tetrahedra);
    fibers = take(16 * n.fibers);
    triangles = take(12 * n.triangles);
    springs = take(n.springs == 0 ? 0 : slices + 2 * n.springs + (n.springs + 1) / 2);
    quadratic = take(n.quadratic == 0 ? 0 : slices + n.quadratic + (n.quadratic + 1) / 2);
  }

 private:
  /// Beginnings are those of 16 bytes.
  PLIANT_HOST_DEVICE int take(int floats) {
    const int begin = end;
    end += (floats + 3) / 4 * 4;
    return begin;
  }
};

/// A block's elements where it keeps them.
struct KeptBlock {
  const BlockShared& layout;
  float* shared;
  BlockCounts n;
  KeptPlaces at;

  PLIANT_HOST_DEVICE KeptBlock(const BlockShared& of, float* memory, const BlockCounts& counts)
      : layout(of), shared(memory), n(counts), at(of, counts, first(of)) {}
  /// What keep() left there.
  PLIANT_HOST_DEVICE KeptBlock(const BlockShared& of, float* memory)
      : KeptBlock(of, memory, *counts_in(of, memory)) {}

  /// The threads' sums come before what is kept.
  PLIANT_HOST_DEVICE static int first(const BlockShared& of) {
    return (of.before_sums() + of.block * kMeasures + 3) / 4 * 4;
  }
  /// Lies where no count has a say.
  PLIANT_HOST_DEVICE static BlockCounts* counts_in(const BlockShared& of, float* memory) {
    return reinterpret_cast<BlockCounts*>(memory + KeptPlaces(of, {}, first(of)).counts);
  }
  PLIANT_HOST_DEVICE SceneState scene() const {
    return {*reinterpret_cast<StepControl*>(shared + at.control),
            *reinterpret_cast<const StepRules*>(shared + at.rules)};
  }
  PLIANT_HOST_DEVICE BlockSimplices simplices(int begin, int count, int quads) const {
    auto* numbers = reinterpret_cast<Float4*>(shared + begin);
    auto* places = reinterpret_cast<UShort4*>(numbers + quads * count);
    auto* rotations = reinterpret_cast<PackedRotation*>(places + 2 * count);
    return {places, places + count, numbers, rotations, count, 0, count};
  }
  PLIANT_HOST_DEVICE BlockSimplices tetrahedra() const {
    return simplices(at.tetrahedra, n.tetrahedra, 3);
  }
  PLIANT_HOST_DEVICE BlockSimplices fibers() const { return simplices(at.fibers, n.fibers, 3); }
  PLIANT_HOST_DEVICE BlockSimplices triangles() const {
    return simplices(at.triangles, n.triangles, 2);
  }
  PLIANT_HOST_DEVICE BlockRows rows(int begin, int count, bool has_a) const {
    if (count == 0) return {};
    const int slices = layout.block / SlicedRowsLayout::kSlice + 1;
    const float* b = shared + begin + slices;
    const float* a = has_a ? b + count : nullptr;
    const float* end = b + (has_a ? 2 : 1) * count;
    return {reinterpret_cast<const int*>(shared + begin),
            reinterpret_cast<const unsigned short*>(end), a, b};
  }
  PLIANT_HOST_DEVICE BlockRows springs() const { return rows(at.springs, n.springs, true); }
  PLIANT_HOST_DEVICE BlockRows quadratic() const { return rows(at.quadratic, n.quadratic, false); }
};

/// The last of the iterations is measured. Of systems with one pass, without clusters and without
/// contacts whose points share particles.
struct IterateInRounds {
  static constexpr int kPhases = 6;
  using Sums = BlockSum<kMeasures>;
  BlockForces forces;
  FinishIteration finish;
  int rounds;

  PLIANT_HOST_DEVICE void operator()(int round, int phase, int block, int thread,
                                     float* shared) const {
    const BlockElements of(forces.elements, forces.layout, block);
    if (phase == 0) {
      if (round == 0) keep(of, thread, shared);
      return;
    }
    const KeptBlock kept(forces.layout, shared);
    const SceneState scene = kept.scene();
    if (scene.control.done_at >= 0) return;
    const Acceleration& accelerate = finish.accelerate;
    const StepArrays& arrays = accelerate.arrays;
    const Turn turn = {(accelerate.turn.from + round) % 2, accelerate.turn.place + round,
                       round + 1 == rounds};
    float* sums = shared + forces.layout.before_sums();
    if (phase == 1) {
      bring(accelerate.source(scene.control, turn), kept, of, thread);
    } else if (phase == 2) {
      simplices(scene, kept, of, turn, thread);
    } else if (phase == 3) {
      if (thread >= arrays.block) return;
      float* own = sums + thread * kMeasures;
      if (turn.measured) Sums::clear(own);
      const int i = block * arrays.block + thread;
      if (i >= arrays.particles) return;
      const Fixed at = forces.layout.positions(shared)[thread];
      finish(scene, turn, i, at, unbalanced(scene, kept, i, thread), own);
    } else if (turn.measured) {
      if (phase == 4) Sums::first(sums, arrays.block, thread);
      if (phase == 5) Sums::second(sums, thread, arrays.partial + block * kMeasures);
    }
  }

  /// Floats that a block of so many elements shares.
  static int shared_floats(const BlockShared& layout, const BlockCounts& counts) {
    return KeptPlaces(layout, counts, KeptBlock::first(layout)).end;
  }

 private:
  template <class T>
  PLIANT_HOST_DEVICE void copy(const T* from, int count, int thread, T* to) const {
    for (int k = thread; k < count; k += forces.threads) to[k] = from[k];
  }

  PLIANT_HOST_DEVICE void keep(const BlockElements& of, int thread, float* shared) const {
    const ElementsView& all = of.all;
    const BlockShared& layout = forces.layout;
    const int p = of.pattern, slices = layout.block / SlicedRowsLayout::kSlice;
    BlockCounts n;
    n.tetrahedra = BlockCounts::count(all.tetrahedra.begins, p, 1);
    n.fibers = BlockCounts::count(all.fibers.begins, p, 1);
    n.triangles = BlockCounts::count(all.triangles.begins, p, 1);
    n.springs = BlockCounts::count(all.springs.begins, p, slices);
    n.quadratic = BlockCounts::count(all.quadratic.begins, p, slices);
    if (thread == 0) *KeptBlock::counts_in(layout, shared) = n;
    const KeptBlock kept(layout, shared, n);
    const StepArrays& arrays = finish.accelerate.arrays;
    const int number = arrays.number_of(of.block);
    copy(reinterpret_cast<const float*>(arrays.control + number),
         sizeof(StepControl) / sizeof(float), thread, shared + kept.at.control);
    copy(reinterpret_cast<const float*>(arrays.rules + number), sizeof(StepRules) / sizeof(float),
         thread, shared + kept.at.rules);
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
    keep(all.quadratic, n.quadratic, of, thread, kept.quadratic());
  }
  PLIANT_HOST_DEVICE void keep(const SimplicesView& view, int count, const BlockElements& of,
                               int quads, int thread, const BlockSimplices& to) const {
    if (count == 0) return;
    const BlockSimplices from = of.simplices(view, 0);
    for (int q = 0; q < quads; ++q) {
      copy(from.numbers + q * from.stride + from.begin, count, thread,
           const_cast<Float4*>(to.numbers) + q * count);
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

  PLIANT_HOST_DEVICE void bring(const Fixed* x, const KeptBlock& kept, const BlockElements& of,
                                int thread) const {
    const BlockShared& layout = forces.layout;
    Fixed* to = layout.positions(kept.shared);
    const int first = of.block * layout.block;
    const int own = finish.accelerate.arrays.particles - first;
    for (int k = thread; k < layout.block && k < own; k += forces.threads) {
      to[k] = load_fresh(x + first + k);
    }
    if (of.all.borders.begins == nullptr) return;
    const Fixed* pattern = x + (of.block - of.pattern) * layout.block;
    const int* begins = of.all.borders.begins + of.pattern;
    const int* places = reinterpret_cast<const int*>(kept.shared + kept.at.border);
    const int count = begins[1] - begins[0];
    for (int k = thread; k < count; k += forces.threads) {
      to[layout.block + k] = load_fresh(pattern + places[k]);
    }
  }

  PLIANT_HOST_DEVICE void simplices(const SceneState& scene, const KeptBlock& kept,
                                    const BlockElements& of, const Turn& turn, int thread) const {
    const SimplexForces onto = {forces.layout.positions(kept.shared), scene.rules.quantum,
                                kept.shared + forces.layout.before_slots()};
    if (kept.n.tetrahedra > 0) {
      const BlockSimplices own = kept.tetrahedra();
      onto.tetrahedra(own, thread, forces.threads);
      if (turn.measured) {
        const BlockSimplices all = of.simplices(of.all.tetrahedra, 0);
        copy<PackedRotation>(own.rotations, own.end, thread, all.rotations + all.begin);
      }
    }
    if (kept.n.fibers > 0) onto.fibers(kept.fibers(), thread, forces.threads);
    if (kept.n.triangles > 0) {
      onto.triangles(kept.triangles(), of.all.materials, thread, forces.threads);
    }
  }

  PLIANT_HOST_DEVICE Float3 unbalanced(const SceneState& scene, const KeptBlock& kept, int i,
                                       int own) const {
    const StepArrays& arrays = finish.accelerate.arrays;
    const Fixed* x = forces.layout.positions(kept.shared);
    const float quantum = scene.rules.quantum;
    const GatheredForces from = {x, quantum};
    Float3 r = held_force(arrays, i, x[own], arrays.predicted[i], quantum);
    r += from.springs(kept.springs(), own);
    r += from.quadratic(kept.quadratic(), own);
    if (forces.elements.slot_begins != nullptr) {
      r += GatheredForces::slots(kept.shared + forces.layout.before_slots(),
                                 reinterpret_cast<const int*>(kept.shared + kept.at.slot_begins),
                                 own);
    }
    return r;
  }
};

}  // namespace pliant
