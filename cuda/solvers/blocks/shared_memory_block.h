#pragma once

#include "cuda/solvers/iteration.h"
#include "cuda/solvers/step_control.h"

/// What a block keeps in shared memory while it iterates on (persistent_iteration.h).
namespace pliant {

/// How many simplices and entries of rows a block has.
struct BlockCounts {
  int tetrahedra = 0, fibers = 0, triangles = 0, springs = 0, cells = 0, quadratic = 0;

  /// `begins_of`: of blocks, or null.
  PLIANT_HOST_DEVICE static int count(const int* begins, int block, int stride) {
    return begins == nullptr ? 0 : begins[(block + 1) * stride] - begins[block * stride];
  }
};

/// Iterations between two looks of the control, as a block counts them.
struct ControlInterval {
  int first, count;  ///< of iterations
  int looks;         ///< so far
};

/// Where in shared memory, behind BlockShared, blocks of at most so many elements have what.
struct SharedMemoryPlaces {
  BlockCounts most;
  int control = 0, rules = 0, counts = 0, interval = 0, slot_begins = 0, border = 0;
  int last = 0, predicted = 0, projected = 0, mobility = 0, collected = 0;
  int tetrahedra = 0, fibers = 0, triangles = 0, springs = 0, cells = 0, quadratic = 0;
  int end = 0;

  SharedMemoryPlaces() = default;
  SharedMemoryPlaces(const BlockShared& layout, const BlockCounts& n)
      : most(n), end(first(layout)) {
    const int slices = layout.block / SlicedRowsLayout::kSlice + 1;
    control = take(static_cast<int>(sizeof(StepControl) / sizeof(float)));
    rules = take(static_cast<int>(sizeof(StepRules) / sizeof(float)));
    counts = take(static_cast<int>(sizeof(BlockCounts) / sizeof(float)));
    interval = take(static_cast<int>(sizeof(ControlInterval) / sizeof(float)));
    last = take(4 * layout.block);
    predicted = take(4 * layout.block);
    projected = take(4 * layout.block);
    mobility = take(layout.block);
    collected = take(9 * layout.block);
    slot_begins = take(layout.block + 1);
    border = take(layout.border);
    // Numbers, places, slots; of tetrahedra the rotations as well.
    tetrahedra = take(18 * n.tetrahedra);
    fibers = take(16 * n.fibers);
    triangles = take(12 * n.triangles);
    springs = take(n.springs == 0 ? 0 : slices + 2 * n.springs + (n.springs + 1) / 2);
    cells = take(n.cells == 0 ? 0 : slices + 2 * n.cells + (n.cells + 1) / 2);
    quadratic = take(n.quadratic == 0 ? 0 : slices + n.quadratic + (n.quadratic + 1) / 2);
  }

 private:
  /// Sums come before these places: those of the block's threads, and those of its scene, which
  /// lie where slots do when none is in use.
  static int first(const BlockShared& of) {
    const int own = of.before_sums() + of.block * kMeasures;
    const int scene = of.before_slots() + SceneSum<kMeasures>::kSharedFloats;
    return ((own > scene ? own : scene) + 3) / 4 * 4;
  }
  /// Beginnings are those of 16 bytes.
  int take(int floats) {
    const int begin = end;
    end += (floats + 3) / 4 * 4;
    return begin;
  }
};

/// What a block keeps in its shared memory, by name.
struct SharedMemoryBlock {
  const BlockShared& layout;
  const SharedMemoryPlaces& at;
  float* shared;

  PLIANT_HOST_DEVICE double* scene_sums() const {
    return reinterpret_cast<double*>(shared + layout.before_slots());
  }
  PLIANT_HOST_DEVICE BlockCounts& counts() const {
    return *reinterpret_cast<BlockCounts*>(shared + at.counts);
  }
  PLIANT_HOST_DEVICE SceneState scene() const {
    return {*reinterpret_cast<StepControl*>(shared + at.control),
            *reinterpret_cast<const StepRules*>(shared + at.rules)};
  }
  PLIANT_HOST_DEVICE ControlInterval& interval() const {
    return *reinterpret_cast<ControlInterval*>(shared + at.interval);
  }
  /// Of the block's own places.
  PLIANT_HOST_DEVICE Fixed* own(int place) const {
    return reinterpret_cast<Fixed*>(shared + place);
  }
  /// Forces on own places: of springs and cells, quadratic rows and simplices, three numbers a
  /// place.
  PLIANT_HOST_DEVICE float* collected(int kind) const {
    return shared + at.collected + kind * 3 * layout.block;
  }
  PLIANT_HOST_DEVICE BlockSimplices tetrahedra() const {
    return simplices(at.tetrahedra, at.most.tetrahedra, counts().tetrahedra, 3);
  }
  PLIANT_HOST_DEVICE BlockSimplices fibers() const {
    return simplices(at.fibers, at.most.fibers, counts().fibers, 3);
  }
  PLIANT_HOST_DEVICE BlockSimplices triangles() const {
    return simplices(at.triangles, at.most.triangles, counts().triangles, 2);
  }
  PLIANT_HOST_DEVICE BlockRows springs() const { return rows(at.springs, at.most.springs, true); }
  PLIANT_HOST_DEVICE BlockRows cells() const { return rows(at.cells, at.most.cells, true); }
  PLIANT_HOST_DEVICE BlockRows quadratic() const {
    return rows(at.quadratic, at.most.quadratic, false);
  }

 private:
  PLIANT_HOST_DEVICE BlockSimplices simplices(int begin, int most, int count, int quads) const {
    auto* numbers = reinterpret_cast<Float4*>(shared + begin);
    auto* places = reinterpret_cast<UShort4*>(numbers + quads * most);
    auto* rotations = reinterpret_cast<PackedRotation*>(places + 2 * most);
    return {places, places + most, numbers, rotations, most, 0, count};
  }
  PLIANT_HOST_DEVICE BlockRows rows(int begin, int most, bool has_a) const {
    if (most == 0) return {};
    const int slices = layout.block / SlicedRowsLayout::kSlice + 1;
    const float* b = shared + begin + slices;
    const float* a = has_a ? b + most : nullptr;
    const float* end = b + (has_a ? 2 : 1) * most;
    return {reinterpret_cast<const int*>(shared + begin),
            reinterpret_cast<const unsigned short*>(end), a, b};
  }
};

}  // namespace pliant
