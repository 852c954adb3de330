#pragma once

#include "cuda/solvers/step_state.h"
#include "cuda/solvers/sums.h"

/// One Jacobi iteration on a packed system, as functions of one thread: x += γ D⁻¹ r with r = M/h²
/// (y - x) + f(x), then contact, then Chebyshev's or Nesterov's step.
namespace pliant {

/// Forces on place i of what it gathers itself.
PLIANT_HOST_DEVICE inline Float3 gathered_force(const ElementsView& e, const Fixed* x, int i,
                                                float quantum) {
  const Fixed at = x[i];
  Float3 f = {0.0f, 0.0f, 0.0f};
  constexpr int kUnroll = SlicedRowsLayout::kUnroll, kSlice = SlicedRowsLayout::kSlice;
  if (e.springs.begins != nullptr) {
    const int end = sliced_end(e.springs.begins, i);
    for (int k = sliced(e.springs.begins, i); k < end; k += kUnroll * kSlice) {
      Float3 way[kUnroll];
      for (int u = 0; u < kUnroll; ++u) {
        way[u] = quantum * (x[e.springs.neighbors[k + kSlice * u]] - at);
      }
      for (int u = 0; u < kUnroll; ++u) {
        f += spring_force(way[u], e.springs.a[k + kSlice * u], e.springs.b[k + kSlice * u]);
      }
    }
  }
  if (e.quadratic.begins != nullptr) {
    const int end = sliced_end(e.quadratic.begins, i);
    for (int k = sliced(e.quadratic.begins, i); k < end; k += kUnroll * kSlice) {
      Float3 way[kUnroll];
      for (int u = 0; u < kUnroll; ++u) {
        way[u] = quantum * (x[e.quadratic.neighbors[k + kSlice * u]] - at);
      }
      for (int u = 0; u < kUnroll; ++u) f += e.quadratic.b[k + kSlice * u] * way[u];
    }
  }
  if (e.clusters.clusters > 0) f += pull_of_clusters(e.clusters, at, i, quantum);
  return f;
}

PLIANT_HOST_DEVICE inline Columns3 shape_at(const SimplicesView& s, int e) {
  Columns3 shape;
  float* numbers = &shape.c[0].x;
  for (int k = 0; k < 9; ++k) numbers[k] = s.shape[k * s.size + e];
  return shape;
}

PLIANT_HOST_DEVICE inline void store(float* shared, unsigned short slot, Float3 f) {
  if (slot == 0xffff) return;
  float* to = shared + 3 * slot;
  to[0] = f.x;
  to[1] = f.y;
  to[2] = f.z;
}

/// Forces of the block's simplices into the slots of their corners.
struct BlockForces {
  ElementsView elements;
  int threads;  ///< of a block

  PLIANT_HOST_DEVICE void operator()(const Fixed* x, float quantum, int block, int thread,
                                     float* shared) const {
    if (elements.tetrahedra.begins != nullptr) {
      const SimplicesView& s = elements.tetrahedra;
      const int end = s.begins[block + 1];
      for (int e = s.begins[block] + thread; e < end; e += threads) {
        Quaternion<float> rotation = Quaternion<float>::identity();
        if (s.rotation != nullptr) {
          const Float4 last = s.rotation[e];
          rotation = {last.w, last.x, last.y, last.z};
        }
        const Columns3 f = tetrahedron_forces(sides(x, s.vertices[e], quantum),
                                              {shape_at(s, e), s.weight[e], s.ratio[e]},
                                              s.rotation != nullptr, rotation);
        if (s.rotation != nullptr) {
          s.rotation[e] = {rotation.x, rotation.y, rotation.z, rotation.w};
        }
        store_all(f, s.slots[e], shared);
      }
    }
    if (elements.fibers.begins != nullptr) {
      const SimplicesView& s = elements.fibers;
      const int end = s.begins[block + 1];
      for (int e = s.begins[block] + thread; e < end; e += threads) {
        const Columns3 f =
            fiber_forces(sides(x, s.vertices[e], quantum), shape_at(s, e), s.weight[e]);
        store_all(f, s.slots[e], shared);
      }
    }
    if (elements.triangles.begins != nullptr) triangles(x, quantum, block, thread, shared);
  }

 private:
  PLIANT_HOST_DEVICE static Columns3 sides(const Fixed* x, const Int4& v, float quantum) {
    const Fixed origin = x[v.v[0]];
    return {{quantum * (x[v.v[1]] - origin), quantum * (x[v.v[2]] - origin),
             quantum * (x[v.v[3]] - origin)}};
  }
  PLIANT_HOST_DEVICE static void store_all(const Columns3& f, const UShort4& slots, float* shared) {
    store(shared, slots.v[0], -1.0f * (f.c[0] + f.c[1] + f.c[2]));
    for (int a = 0; a < 3; ++a) store(shared, slots.v[a + 1], f.c[a]);
  }
  PLIANT_HOST_DEVICE void triangles(const Fixed* x, float quantum, int block, int thread,
                                    float* shared) const {
    const SimplicesView& s = elements.triangles;
    const int end = s.begins[block + 1];
    for (int e = s.begins[block] + thread; e < end; e += threads) {
      const Int4 v = s.vertices[e];
      const UShort4 slots = s.slots[e];
      const Fixed origin = x[v.v[0]];
      const Float4 shape = {s.shape[e], s.shape[s.size + e], s.shape[2 * s.size + e],
                            s.shape[3 * s.size + e]};
      const TriangleForces f =
          triangle_forces(quantum * (x[v.v[1]] - origin), quantum * (x[v.v[2]] - origin), shape,
                          s.weight[e], elements.materials[s.material[e]]);
      store(shared, slots.v[0], -1.0f * (f.f1 + f.f2));
      store(shared, slots.v[1], f.f1);
      store(shared, slots.v[2], f.f2);
    }
  }
};

/// Unbalanced force on place i of `block`; simplices' forces stand in `shared`.
PLIANT_HOST_DEVICE inline Float3 unbalanced_force(const ElementsView& elements,
                                                  const StepArrays& arrays, const Fixed* x, int i,
                                                  int block, float quantum, const float* shared) {
  const Fixed at = x[i], y = arrays.predicted[i];
  Float3 r = (quantum * y.w) * (y - at);
  r += gathered_force(elements, x, i, quantum);
  if (arrays.anchors != nullptr) {
    const Fixed anchor = arrays.anchors[i];
    r += (quantum * anchor.w) * (anchor - at);
  }
  if (elements.slot_begins != nullptr) {
    const int* begins =
        elements.slot_begins + block * (arrays.block + 1) + i - block * arrays.block;
    const int end = 3 * begins[1];
    for (int k = 3 * begins[0]; k < end; k += 3) {
      r += Float3{shared[k], shared[k + 1], shared[k + 2]};
    }
  }
  return r;
}

/// Contact and friction of a particle that shares its contacts with no other: out along each
/// normal, then the slip is cut by what the cones allow. `u` is the way from the prediction [m].
/// Returns how many carry force.
PLIANT_HOST_DEVICE inline int touch(const ContactsView& view, int number, float mobility,
                                    Float3& u) {
  int active = 0;
  const int begin = view.begins[number], end = view.begins[number + 1];
  for (int k = begin; k < end; ++k) {
    const int c = view.entries[k] / 4;
    const Float4 plane = view.contacts[c].plane;
    const float gap = plane.w + dot(plane.xyz(), u);
    const float push = gap < 0.0f ? -gap : 0.0f;
    u += push * plane.xyz();
    view.forces[c] = {push / mobility, {0.0f, 0.0f, 0.0f}};
    if (push > 0.0f) ++active;
  }
  for (int k = begin; k < end && active > 0; ++k) {
    const int c = view.entries[k] / 4;
    const Float4 plane = view.contacts[c].plane, start = view.contacts[c].slip;
    const float bound = start.w * view.forces[c].normal;
    if (bound <= 0.0f) continue;
    Float3 slip = start.xyz() + u;
    slip -= dot(plane.xyz(), slip) * plane.xyz();
    Float3 force = (-1.0f / mobility) * slip;
    const float size = norm(force);
    if (size > bound) force = (bound / size) * force;
    view.forces[c].friction = force;
    u += mobility * force;
  }
  return active;
}

/// Positions far outside the body would soon be too many quanta to count.
PLIANT_HOST_DEVICE inline bool is_in_range(const Fixed& x) {
  constexpr int kMost = 1 << 30;
  return x.x > -kMost && x.x < kMost && x.y > -kMost && x.y < kMost && x.z > -kMost && x.z < kMost;
}

/// From J(y) to the next iterate.
struct Acceleration {
  StepArrays arrays;
  int from;   ///< which of the two x holds y; the other one takes the next
  int place;  ///< of the iteration in its interval
  bool measured;

  PLIANT_HOST_DEVICE static bool runs(const StepControl& control) { return control.done_at < 0; }
  /// y: the best state where the control went back to it.
  PLIANT_HOST_DEVICE const Fixed* source(const StepControl& control) const {
    return control.revert && place == 0 ? arrays.saved[control.best] : arrays.x[from];
  }

  /// `j` is J(y), to where forces moved it by `way` and contact by `push` [m]. Writes kMeasures
  /// numbers to `sums` if measured.
  PLIANT_HOST_DEVICE void operator()(const SceneState& scene, int i, const Fixed& j, Float3 way,
                                     Float3 push, int active, float* sums) const {
    const StepControl& control = scene.control;
    const float factor = control.factors[place];
    Fixed next = j, before = j;
    if (control.mode == StepControl::kMomentum) {
      before = arrays.landed[i];
      if (factor != 0.0f) next = moved(j, factor * (j - before));
      arrays.landed[i] = j;
    } else if (factor != 1.0f) {
      const Fixed previous = arrays.x[1 - from][i];
      next = moved(previous, factor * (j - previous));
    }
    arrays.x[1 - from][i] = next;
    if (!measured) return;
    arrays.saved[1 - control.best][i] = j;
    if (control.mode != StepControl::kMomentum) arrays.landed[i] = j;
    const float mobility = arrays.mobility[i];
    // D = γ / mobility; γ follows in the control kernel.
    const float d = mobility > 0.0f ? 1.0f / mobility : 0.0f;
    const Float3 change = way + push;
    sums[kChange] = is_in_range(next) ? d * dot(change, change) : HUGE_VALF;
    sums[kUphill] = -d * dot(change, scene.rules.quantum * (j - before));
    sums[kActive] = static_cast<float>(active);
    sums[kContact] = d * dot(push, push);
    sums[kPulled] = d * dot(way, way);
  }
};

/// A whole iteration; of scenes with contacts whose points share particles all up to these, with
/// J(y) so far in raw and pushed.
struct Iterate {
  static constexpr int kPhases = 4;
  BlockForces forces;
  ContactsView contacts;
  Acceleration accelerate;
  int slots;  ///< floats of shared memory before the threads' sums

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const StepArrays& arrays = accelerate.arrays;
    const SceneState scene = arrays.scene_with(block);
    if (scene.control.done_at >= 0) return;
    const Fixed* x = accelerate.source(scene.control);
    if (phase == 0) {
      forces(x, scene.rules.quantum, block, thread, shared);
    } else if (phase == 1) {
      if (thread >= arrays.block) return;
      float* sums = shared + slots + thread * kMeasures;
      if (accelerate.measured) Sums::clear(sums);
      const int i = block * arrays.block + thread;
      if (i < arrays.particles) update(scene, x, i, block, shared, sums);
    } else if (accelerate.measured && !scene.rules.carried) {
      if (phase == 2) Sums::first(shared + slots, arrays.block, thread);
      if (phase == 3) Sums::second(shared + slots, thread, arrays.partial + block * kMeasures);
    }
  }

 private:
  using Sums = BlockSum<kMeasures>;

  PLIANT_HOST_DEVICE void update(const SceneState& scene, const Fixed* x, int i, int block,
                                 const float* shared, float* sums) const {
    const StepArrays& arrays = accelerate.arrays;
    const float quantum = scene.rules.quantum;
    const float mobility = scene.control.slow * arrays.mobility[i];
    const Float3 way =
        mobility * unbalanced_force(forces.elements, arrays, x, i, block, quantum, shared);
    const Fixed raw = moved(x[i], (1.0f / quantum) * way);
    if (scene.rules.carried) {
      arrays.raw[i] = arrays.pushed[i] = raw;
      return;
    }
    const int number = contacts.any && mobility > 0.0f ? contacts.first[i] : -1;
    if (number < 0) {
      accelerate(scene, i, raw, way, {0.0f, 0.0f, 0.0f}, 0, sums);
      return;
    }
    const Float3 from = quantum * (raw - arrays.predicted[i]);
    Float3 u = from;
    const int active = touch(contacts, number, mobility, u);
    const Float3 push = u - from;
    accelerate(scene, i, moved(raw, (1.0f / quantum) * push), way, push, active, sums);
  }
};

}  // namespace pliant
