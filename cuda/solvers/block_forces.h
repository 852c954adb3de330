#pragma once

#include "cuda/elements/place_pair.h"
#include "cuda/solvers/step_state.h"
#include "pliant/laws/spring.h"

/// Forces on the particles of a block (vertex_blocks.h), as functions of one thread: nothing is
/// added to by two of them.
namespace pliant {

/// What the threads of a block share: the positions that they read, those of its border behind its
/// own; then slots of forces; then what the first of two passes gave; then their sums.
struct BlockShared {
  int block = 0;   ///< particles of a block
  int border = 0;  ///< at the most
  int slots = 0;   ///< likewise
  int passes = 1;  ///< over simplices

  PLIANT_HOST_DEVICE const Fixed* positions(const float* shared) const {
    return reinterpret_cast<const Fixed*>(shared);
  }
  PLIANT_HOST_DEVICE Fixed* positions(float* shared) const {
    return reinterpret_cast<Fixed*>(shared);
  }
  PLIANT_HOST_DEVICE int before_slots() const { return 4 * (block + border); }
  PLIANT_HOST_DEVICE int before_first() const { return before_slots() + 3 * slots; }
  PLIANT_HOST_DEVICE int before_sums() const { return before_first() + 3 * block * (passes - 1); }
};

/// Simplices of one block, wherever they lie.
struct BlockSimplices {
  const UShort4* places;
  const UShort4* slots;
  const Float4* numbers;      ///< quads, `stride` apart
  PackedRotation* rotations;  ///< of the last iteration; null: not of tetrahedra
  int stride, begin, end;
};

/// Rows of the places of one block; slices of it begin at begins[0], begins[1], ...
struct BlockRows {
  const int* begins;  ///< null: none
  const unsigned short* neighbors;
  const float* a;
  const float* b;
};

/// Everything that a block computes forces of, from the memory that holds all blocks.
struct BlockElements {
  const ElementsView& all;
  const BlockShared& layout;
  int block, pattern;

  PLIANT_HOST_DEVICE BlockElements(const ElementsView& elements, const BlockShared& of, int number)
      : all(elements), layout(of), block(number), pattern(elements.pattern_of(number)) {}

  PLIANT_HOST_DEVICE BlockSimplices simplices(const SimplicesView& s, int pass) const {
    // Of each copy of a shared pattern its own.
    const int copy = all.shared_blocks > 0 ? block / all.shared_blocks : 0;
    PackedRotation* rotations =
        s.rotation == nullptr ? nullptr : s.rotation + static_cast<std::size_t>(copy) * s.size;
    const int* begins = s.begins + pattern * layout.passes + pass;
    return {s.places, s.slots, s.numbers, rotations, s.size, begins[0], begins[1]};
  }
  PLIANT_HOST_DEVICE BlockRows rows(const LocalRowsView& r) const {
    if (r.begins == nullptr) return {};
    const int slices = layout.block / SlicedRowsLayout::kSlice;
    return {r.begins + pattern * slices, r.neighbors, r.a, r.b};
  }
  /// First slot of each place, and the end.
  PLIANT_HOST_DEVICE const int* slot_begins(int pass) const {
    if (all.slot_begins == nullptr) return nullptr;
    return all.slot_begins + (pattern * layout.passes + pass) * (layout.block + 1);
  }
};

/// Forces of simplices into the slots of their corners. `x`: positions that the block shares.
struct SimplexForces {
  const Fixed* x;
  float quantum;
  float* slots;

  PLIANT_HOST_DEVICE void tetrahedra(const BlockSimplices& s, int thread, int threads) const {
    // Near the last rotation the search is short. What is rare waits: a call of all of it would
    // take the registers of the rest.
    bool is_any_far = false;
    for (int e = s.begin + thread; e < s.end; e += threads) {
      const TetrahedronShape shape = shape_at(s, e);
      const Matrix3<float> g = gradient_of(sides(s.places[e]), shape.shape);
      Quaternion<float> rotation = unpacked(s.rotations[e]);
      if (!refined_rotation(g, rotation)) {
        is_any_far = true;
        s.rotations[e] = {};
        continue;
      }
      s.rotations[e] = packed(rotation);
      store_all(tetrahedron_forces(g, shape, rotation), s.slots[e]);
    }
    if (is_any_far) far_tetrahedra(s, thread, threads);
  }
  PLIANT_HOST_DEVICE void fibers(const BlockSimplices& s, int thread, int threads) const {
    for (int e = s.begin + thread; e < s.end; e += threads) {
      const TetrahedronShape shape = shape_at(s, e);
      store_all(fiber_forces(sides(s.places[e]), shape.shape, shape.weight), s.slots[e]);
    }
  }
  PLIANT_HOST_DEVICE void triangles(const BlockSimplices& s,
                                    const MembraneConstants<float>* materials, int thread,
                                    int threads) const {
    for (int e = s.begin + thread; e < s.end; e += threads) {
      const UShort4 v = s.places[e], to = s.slots[e];
      const Fixed origin = x[v.v[0]];
      const Float4 shape = s.numbers[e], more = s.numbers[s.stride + e];
      const TriangleForces f =
          triangle_forces(quantum * (x[v.v[1]] - origin), quantum * (x[v.v[2]] - origin), shape,
                          more.x, materials[static_cast<int>(more.y)]);
      store(to.v[0], -1.0f * (f.f1 + f.f2));
      store(to.v[1], f.f1);
      store(to.v[2], f.f2);
    }
  }

 private:
  PLIANT_RARE_PATH PLIANT_HOST_DEVICE void far_tetrahedra(const BlockSimplices& s, int thread,
                                                          int threads) const {
    for (int e = s.begin + thread; e < s.end; e += threads) {
      if (!is_unknown(s.rotations[e])) continue;
      const TetrahedronShape shape = shape_at(s, e);
      const Matrix3<float> g = gradient_of(sides(s.places[e]), shape.shape);
      const Quaternion<float> rotation = nearest_rotation(g);
      s.rotations[e] = packed(rotation);
      store_all(tetrahedron_forces(g, shape, rotation), s.slots[e]);
    }
  }
  PLIANT_HOST_DEVICE static TetrahedronShape shape_at(const BlockSimplices& s, int e) {
    const Float4 a = s.numbers[e], b = s.numbers[s.stride + e], c = s.numbers[2 * s.stride + e];
    return {{{{a.x, a.y, a.z}, {a.w, b.x, b.y}, {b.z, b.w, c.x}}}, c.y, c.z};
  }
  PLIANT_HOST_DEVICE Columns3 sides(const UShort4& v) const {
    const Fixed origin = x[v.v[0]];
    return {{quantum * (x[v.v[1]] - origin), quantum * (x[v.v[2]] - origin),
             quantum * (x[v.v[3]] - origin)}};
  }
  PLIANT_HOST_DEVICE void store(unsigned short slot, Float3 f) const {
    if (slot == 0xffff) return;
    float* to = slots + 3 * slot;
    to[0] = f.x;
    to[1] = f.y;
    to[2] = f.z;
  }
  PLIANT_HOST_DEVICE void store_all(const Columns3& f, const UShort4& to) const {
    store(to.v[0], -1.0f * (f.c[0] + f.c[1] + f.c[2]));
    for (int a = 0; a < 3; ++a) store(to.v[a + 1], f.c[a]);
  }
};

/// Forces on places of what they gather. `x`: positions that the block shares.
struct GatheredForces {
  const Fixed* x;
  float quantum;

  /// And of cells, which shear.
  PLIANT_HOST_DEVICE Float3 springs(const BlockRows& rows, const BlockRows& cells, int own) const {
    const Float3 f =
        sum<SlicedRowsLayout::kUnroll>(rows, own, [&](const Float3& offset, int entry) {
          const Float3 d = quantum * offset;
          return spring_share(rows.b[entry], rows.a[entry], divisor_of(d)) * d;
        });
    return f +
           sum<SlicedRowsLayout::kShortUnroll>(cells, own, [&](const Float3& offset, int entry) {
             const PlacePair ends = pair_of(cells.a[entry]);
             const Float3 d = quantum * offset, e = quantum * (x[ends.first] - x[ends.second]);
             return cell_share(cells.b[entry], divisor_of(d), divisor_of(e)) * d;
           });
  }
  PLIANT_HOST_DEVICE Float3 quadratic(const BlockRows& rows, int own) const {
    return sum<SlicedRowsLayout::kUnroll>(rows, own, [&](const Float3& offset, int entry) {
      return (quantum * rows.b[entry]) * offset;
    });
  }
  PLIANT_HOST_DEVICE static Float3 slots(const float* slots, const int* begins, int own) {
    Float3 f = {0.0f, 0.0f, 0.0f};
    if (begins == nullptr) return f;
    const int end = 3 * begins[own + 1];
    for (int k = 3 * begins[own]; k < end; k += 3) {
      f += Float3{slots[k], slots[k + 1], slots[k + 2]};
    }
    return f;
  }
  /// Its component, in the same order.
  PLIANT_HOST_DEVICE static float slots(const float* slots, const int* begins, int own,
                                        int component) {
    constexpr int kAtOnce = 4;
    float f = 0.0f;
    const int end = 3 * begins[own + 1] + component;
    int k = 3 * begins[own] + component;
    for (; k + 3 * (kAtOnce - 1) < end; k += 3 * kAtOnce) {
      const float a = slots[k], b = slots[k + 3], c = slots[k + 6], d = slots[k + 9];
      f = ((f + a) + b + c) + d;
    }
    for (; k < end; k += 3) f += slots[k];
    return f;
  }

 private:
  /// Of what each entry exerts, by the offset to its neighbour in quanta.
  template <int kUnroll, class Force>
  PLIANT_HOST_DEVICE Float3 sum(const BlockRows& rows, int own, const Force& force) const {
    constexpr int kSlice = SlicedRowsLayout::kSlice;
    Float3 f = {0.0f, 0.0f, 0.0f};
    if (rows.begins == nullptr) return f;
    const Fixed at = x[own];
    const int end = sliced_end(rows.begins, own);
    for (int k = sliced(rows.begins, own); k < end; k += kUnroll * kSlice) {
      for (int entry = k; entry < k + kUnroll * kSlice; entry += kSlice) {
        f += force(x[rows.neighbors[entry]] - at, entry);
      }
    }
    return f;
  }
};

/// M/h² (y - x) and attachments, of place i, which is at `at`.
PLIANT_HOST_DEVICE inline Float3 held_force(const StepArrays& arrays, int i, const Fixed& at,
                                            const Fixed& y, float quantum) {
  Float3 r = (quantum * y.w) * (y - at);
  if (arrays.anchors != nullptr) {
    const Fixed anchor = arrays.anchors[i];
    r += (quantum * anchor.w) * (anchor - at);
  }
  return r;
}

/// Forces of a block in kPhases phases: every thread brings positions, then simplices put their
/// forces into slots, which particles sum up, in up to two passes; after that unbalanced() tells
/// each particle its own.
struct BlockForces {
  static constexpr int kPhases = 4;
  // What large bodies wait for is latency: registers for 72 a thread leave 28 warps a
  // multiprocessor (docs/performance.md).
  static constexpr int kMostThreads = 448, kLeastBlocks = 2;
  ElementsView elements;
  int threads;  ///< of a block
  BlockShared layout;

  PLIANT_HOST_DEVICE void operator()(int phase, const StepArrays& arrays, const Fixed* x,
                                     float quantum, int block, int thread, float* shared) const {
    const BlockElements of(elements, layout, block);
    if (phase == 0) return bring(x, arrays.particles, of, thread, shared);
    if (phase == 1) return simplices(quantum, of, 0, thread, shared);
    if (layout.passes == 1) return;
    if (phase == 3) return simplices(quantum, of, 1, thread, shared);
    if (thread >= layout.block) return;
    const Float3 first =
        GatheredForces::slots(shared + layout.before_slots(), of.slot_begins(0), thread);
    float* to = shared + layout.before_first() + 3 * thread;
    to[0] = first.x;
    to[1] = first.y;
    to[2] = first.z;
  }

  /// Unbalanced force on place i of `block`, the threads' own.
  PLIANT_HOST_DEVICE Float3 unbalanced(const StepArrays& arrays, int i, int block, float quantum,
                                       const float* shared) const {
    const Fixed* x = layout.positions(shared);
    const int own = i - block * layout.block;
    const BlockElements of(elements, layout, block);
    const GatheredForces forces = {x, quantum};
    Float3 r = held_force(arrays, i, x[own], arrays.predicted[i], quantum);
    r += forces.springs(of.rows(elements.springs), of.rows(elements.cells), own);
    r += forces.quadratic(of.rows(elements.quadratic), own);
    if (elements.clusters.clusters > 0) {
      r += pull_of_clusters(elements.clusters, x[own], i, quantum);
    }
    if (layout.passes > 1) {
      const float* first = shared + layout.before_first() + 3 * own;
      r += Float3{first[0], first[1], first[2]};
    }
    r += GatheredForces::slots(shared + layout.before_slots(), of.slot_begins(layout.passes - 1),
                               own);
    return r;
  }

 private:
  /// `particles`: of all blocks.
  PLIANT_HOST_DEVICE void bring(const Fixed* x, int particles, const BlockElements& of, int thread,
                                float* shared) const {
    Fixed* to = layout.positions(shared);
    const int first = of.block * layout.block, own = particles - first;
    for (int k = thread; k < layout.block && k < own; k += threads) {
      to[k] = load_fresh(x + first + k);
    }
    if (elements.borders.begins == nullptr) return;
    const Fixed* pattern = x + (of.block - of.pattern) * layout.block;
    const int begin = elements.borders.begins[of.pattern];
    const int count = elements.borders.begins[of.pattern + 1] - begin;
    for (int k = thread; k < count; k += threads) {
      to[layout.block + k] = load_fresh(pattern + elements.borders.places[begin + k]);
    }
  }

  PLIANT_HOST_DEVICE void simplices(float quantum, const BlockElements& of, int pass, int thread,
                                    float* shared) const {
    const SimplexForces forces = {layout.positions(shared), quantum,
                                  shared + layout.before_slots()};
    if (elements.tetrahedra.begins != nullptr) {
      forces.tetrahedra(of.simplices(elements.tetrahedra, pass), thread, threads);
    }
    if (elements.fibers.begins != nullptr) {
      forces.fibers(of.simplices(elements.fibers, pass), thread, threads);
    }
    if (elements.triangles.begins != nullptr) {
      forces.triangles(of.simplices(elements.triangles, pass), elements.materials, thread, threads);
    }
  }
};

}  // namespace pliant
