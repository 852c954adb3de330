#pragma once

#include "cuda/solvers/step_state.h"

/// One Jacobi iteration on a packed system, as functions of one thread: x += γ D⁻¹ r with r = M/h²
/// (y - x) + f(x), then contact, then Chebyshev's or Nesterov's step.
namespace pliant {

PLIANT_HOST_DEVICE inline int sliced(const int* begins, int i) { return begins[i / 32] + i % 32; }
PLIANT_HOST_DEVICE inline int sliced_end(const int* begins, int i) { return begins[i / 32 + 1]; }

/// Forces on place i of what it gathers itself.
PLIANT_HOST_DEVICE inline Float3 gathered_force(const ElementsView& e, const Float4* x, int i,
                                                Float3 at) {
  Float3 f = {0.0f, 0.0f, 0.0f};
  if (e.springs.begins != nullptr) {
    const int end = sliced_end(e.springs.begins, i);
    for (int k = sliced(e.springs.begins, i); k < end; k += 32) {
      f += spring_force(x[e.springs.neighbors[k]].xyz() - at, e.springs.a[k], e.springs.b[k]);
    }
  }
  if (e.quadratic.begins != nullptr) {
    const int end = sliced_end(e.quadratic.begins, i);
    for (int k = sliced(e.quadratic.begins, i); k < end; k += 32) {
      f += e.quadratic.b[k] * (x[e.quadratic.neighbors[k]].xyz() - at);
    }
  }
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

  PLIANT_HOST_DEVICE void operator()(const Float4* x, int block, int thread, float* shared) const {
    if (elements.tetrahedra.begins != nullptr) {
      const SimplicesView& s = elements.tetrahedra;
      const int end = s.begins[block + 1];
      for (int e = s.begins[block] + thread; e < end; e += threads) {
        const Int4 v = s.vertices[e];
        const Columns3 f =
            tetrahedron_forces(sides(x, v), {shape_at(s, e), s.weight[e], s.ratio[e]});
        store_all(f, s.slots[e], shared);
      }
    }
    if (elements.fibers.begins != nullptr) {
      const SimplicesView& s = elements.fibers;
      const int end = s.begins[block + 1];
      for (int e = s.begins[block] + thread; e < end; e += threads) {
        const Columns3 f = fiber_forces(sides(x, s.vertices[e]), shape_at(s, e), s.weight[e]);
        store_all(f, s.slots[e], shared);
      }
    }
    if (elements.triangles.begins != nullptr) triangles(x, block, thread, shared);
  }

 private:
  PLIANT_HOST_DEVICE static Columns3 sides(const Float4* x, const Int4& v) {
    const Float3 origin = x[v.v[0]].xyz();
    return {{x[v.v[1]].xyz() - origin, x[v.v[2]].xyz() - origin, x[v.v[3]].xyz() - origin}};
  }
  PLIANT_HOST_DEVICE static void store_all(const Columns3& f, const UShort4& slots, float* shared) {
    store(shared, slots.v[0], -1.0f * (f.c[0] + f.c[1] + f.c[2]));
    for (int a = 0; a < 3; ++a) store(shared, slots.v[a + 1], f.c[a]);
  }
  PLIANT_HOST_DEVICE void triangles(const Float4* x, int block, int thread, float* shared) const {
    const SimplicesView& s = elements.triangles;
    const int end = s.begins[block + 1];
    for (int e = s.begins[block] + thread; e < end; e += threads) {
      const Int4 v = s.vertices[e];
      const UShort4 slots = s.slots[e];
      const Float3 origin = x[v.v[0]].xyz();
      const Float4 shape = {s.shape[e], s.shape[s.size + e], s.shape[2 * s.size + e],
                            s.shape[3 * s.size + e]};
      const TriangleForces f =
          triangle_forces(x[v.v[1]].xyz() - origin, x[v.v[2]].xyz() - origin, shape, s.weight[e],
                          elements.materials[s.material[e]]);
      store(shared, slots.v[0], -1.0f * (f.f1 + f.f2));
      store(shared, slots.v[1], f.f1);
      store(shared, slots.v[2], f.f2);
    }
  }
};

/// Unbalanced force on place i of `block`; simplices' forces stand in `shared`.
PLIANT_HOST_DEVICE inline Float3 unbalanced_force(const ElementsView& elements,
                                                  const StepArrays& arrays, const Float4* x, int i,
                                                  int block, const float* shared) {
  const Float3 at = x[i].xyz();
  const Float4 y = arrays.predicted[i];
  Float3 r = y.w * (y.xyz() - at);
  r += gathered_force(elements, x, i, at);
  if (arrays.anchors != nullptr) {
    const Float4 anchor = arrays.anchors[i];
    r += anchor.xyz() - anchor.w * at;
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
/// normal, then the slip is cut by what the cones allow. Returns how many carry force.
PLIANT_HOST_DEVICE inline int touch(const ContactsView& view, int number, float mobility,
                                    Float3& x) {
  int active = 0;
  const int begin = view.begins[number], end = view.begins[number + 1];
  for (int k = begin; k < end; ++k) {
    const int c = view.entries[k] / 4;
    const Float4 plane = view.contacts[c].plane;
    const float gap = dot(plane.xyz(), x) - plane.w;
    const float push = gap < 0.0f ? -gap : 0.0f;
    x += push * plane.xyz();
    view.forces[c] = {push / mobility, {0.0f, 0.0f, 0.0f}};
    if (push > 0.0f) ++active;
  }
  for (int k = begin; k < end && active > 0; ++k) {
    const int c = view.entries[k] / 4;
    const Float4 plane = view.contacts[c].plane, reference = view.contacts[c].reference;
    const float bound = reference.w * view.forces[c].normal;
    if (bound <= 0.0f) continue;
    Float3 slip = x - reference.xyz();
    slip -= dot(plane.xyz(), slip) * plane.xyz();
    Float3 force = (-1.0f / mobility) * slip;
    const float size = norm(force);
    if (size > bound) force = (bound / size) * force;
    view.forces[c].friction = force;
    x += mobility * force;
  }
  return active;
}

/// From J(y) to the next iterate.
struct Acceleration {
  StepArrays arrays;
  int from;   ///< which of the two x holds y; the other one takes the next
  int place;  ///< of the iteration in its interval
  bool measured;

  /// `raw` is J(y) before contact. Writes kMeasures numbers to `sums` if measured.
  PLIANT_HOST_DEVICE void operator()(int i, Float3 raw, Float3 j, int active, float* sums) const {
    const StepControl& control = *arrays.control;
    const Float3 y = arrays.x[from][i].xyz();
    const float factor = control.factors[place];
    Float3 next = j, before = j;
    if (control.mode == StepControl::kMomentum) {
      before = arrays.landed[i].xyz();
      if (factor != 0.0f) next = j + factor * (j - before);
      arrays.landed[i] = with_w(j, 0.0f);
    } else {
      if (factor != 1.0f) {
        const Float3 previous = arrays.x[1 - from][i].xyz();
        next = factor * (j - previous) + previous;
      }
      if (measured) arrays.landed[i] = with_w(j, 0.0f);
    }
    arrays.x[1 - from][i] = with_w(next, 0.0f);
    if (!measured) return;
    const float mobility = arrays.mobility[i];
    // D = γ / mobility; γ follows in the control kernel.
    const float d = mobility > 0.0f ? 1.0f / mobility : 0.0f;
    sums[kChange] = d * dot(j - y, j - y);
    sums[kUphill] = d * dot(y - j, j - before);
    sums[kActive] = static_cast<float>(active);
    sums[kContact] = d * dot(j - raw, j - raw);
    sums[kPulled] = d * dot(raw - y, raw - y);
  }
};

/// Sums of a block's threads, which lie in `sums` one thread after the other, in a fixed order.
PLIANT_HOST_DEVICE inline void sum_block(const float* sums, int threads, int block, int thread,
                                         float* partial) {
  if (thread >= kMeasures) return;
  float sum = 0.0f;
  for (int t = 0; t < threads; ++t) sum += sums[t * kMeasures + thread];
  partial[block * kMeasures + thread] = sum;
}

/// A whole iteration, except contacts of points that share particles.
struct Iterate {
  static constexpr int kPhases = 3;
  BlockForces forces;
  ContactsView contacts;  ///< of particles, or none
  bool carried;           ///< contacts of carried points follow: leave J(y) in raw and pushed
  Acceleration accelerate;
  int slots;  ///< floats of shared memory before the threads' sums

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const StepArrays& arrays = accelerate.arrays;
    if (arrays.control->done_at >= 0) return;
    const Float4* x = arrays.x[accelerate.from];
    if (phase == 0) {
      forces(x, block, thread, shared);
    } else if (phase == 1) {
      float* sums = shared + slots + thread * kMeasures;
      if (accelerate.measured) {
        for (int m = 0; m < kMeasures; ++m) sums[m] = 0.0f;
      }
      const int i = block * arrays.block + thread;
      if (thread < arrays.block && i < arrays.particles) update(x, i, block, shared, sums);
    } else if (accelerate.measured && !carried) {
      sum_block(shared + slots, forces.threads, block, thread, arrays.partial);
    }
  }

 private:
  /// x + `way`. Many short ways of a slow iteration would vanish in the rounding of x: what is lost
  /// goes into the next one (Kahan 1965).
  PLIANT_HOST_DEVICE Float3 moved(Float3 x, Float3 way, int i) const {
    Float4* carry = accelerate.arrays.carry;
    if (carry == nullptr) return x + way;
    way += carry[i].xyz();
    const Float3 to = x + way;
    carry[i] = with_w(way - (to - x), 0.0f);
    return to;
  }

  PLIANT_HOST_DEVICE void update(const Float4* x, int i, int block, const float* shared,
                                 float* sums) const {
    const StepArrays& arrays = accelerate.arrays;
    const Float3 r = unbalanced_force(forces.elements, arrays, x, i, block, shared);
    const float mobility = arrays.control->slow * arrays.mobility[i];
    const Float3 raw = moved(x[i].xyz(), mobility * r, i);
    if (carried) {
      arrays.raw[i] = arrays.pushed[i] = with_w(raw, 0.0f);
      return;
    }
    Float3 j = raw;
    int active = 0;
    if (contacts.any && mobility > 0.0f) {
      const int number = contacts.first[i];
      if (number >= 0) active = touch(contacts, number, mobility, j);
    }
    accelerate(i, raw, j, active, sums);
  }
};

/// Contacts of points that share particles: sweeps over all of them by one block. Each gives its
/// particles the part of the correction that they would need alone, over the number of contacts
/// that move each of them (mass splitting, Tonge et al. 2012): then all together never overshoot.
struct CarriedContacts {
  static constexpr int kSweeps = 6;
  static constexpr int kPhases = 2 * kSweeps + 1;
  StepArrays arrays;
  ContactsView view;
  int threads;

  PLIANT_HOST_DEVICE void operator()(int phase, int, int thread, float*) const {
    if (arrays.control->done_at >= 0) return;
    if (phase % 2 == 0) {
      for (int n = thread; n < view.counts[1]; n += threads) move(n);
    } else {
      for (int c = thread; c < view.counts[0]; c += threads) correct(c);
    }
  }

 private:
  /// The particle to where all forces put it.
  PLIANT_HOST_DEVICE void move(int n) const {
    const int i = view.touched[n];
    Float3 force = {0.0f, 0.0f, 0.0f};
    for (int k = view.begins[n]; k < view.begins[n + 1]; ++k) {
      const int c = view.entries[k] / 4;
      const float weight = (&view.contacts[c].weights.x)[view.entries[k] % 4];
      const DeviceContactForce& f = view.forces[c];
      force += weight * (f.normal * view.contacts[c].plane.xyz() + f.friction);
    }
    const float mobility = arrays.control->slow * arrays.mobility[i];
    arrays.pushed[i] = with_w(arrays.raw[i].xyz() + mobility * force, 0.0f);
  }

  PLIANT_HOST_DEVICE void correct(int c) const {
    const DeviceContact& contact = view.contacts[c];
    Float3 at = {0.0f, 0.0f, 0.0f};
    float own = 0.0f;
    for (int a = 0; a < 4 && contact.particles.v[a] >= 0; ++a) {
      const int i = contact.particles.v[a];
      const float weight = (&contact.weights.x)[a];
      const int n = view.first[i];
      const auto shares = static_cast<float>(view.begins[n + 1] - view.begins[n]);
      at += weight * arrays.pushed[i].xyz();
      own += weight * weight * shares * arrays.control->slow * arrays.mobility[i];
    }
    if (own == 0.0f) return;
    DeviceContactForce& f = view.forces[c];
    const Float3 normal = contact.plane.xyz();
    const float gap = dot(normal, at) - contact.plane.w;
    const float wanted = f.normal - gap / own;
    f.normal = wanted > 0.0f ? wanted : 0.0f;
    Float3 slip = at - contact.reference.xyz();
    slip -= dot(normal, slip) * normal;
    Float3 friction = f.friction - (1.0f / own) * slip;
    const float size = norm(friction), bound = contact.reference.w * f.normal;
    if (size > bound) friction = (bound / size) * friction;
    f.friction = friction;
  }
};

/// The rest of an iteration with contacts of carried points.
struct AccelerateCarried {
  static constexpr int kPhases = 2;
  Acceleration accelerate;
  ContactsView view;
  int threads;

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const StepArrays& arrays = accelerate.arrays;
    if (arrays.control->done_at >= 0) return;
    if (phase == 0) {
      float* sums = shared + thread * kMeasures;
      if (accelerate.measured) {
        for (int m = 0; m < kMeasures; ++m) sums[m] = 0.0f;
      }
      const int i = block * arrays.block + thread;
      if (thread >= arrays.block || i >= arrays.particles) return;
      accelerate(i, arrays.raw[i].xyz(), arrays.pushed[i].xyz(), active(i), sums);
    } else if (accelerate.measured) {
      sum_block(shared, threads, block, thread, arrays.partial);
    }
  }

 private:
  /// Contacts that count with particle i: those whose first corner it is.
  PLIANT_HOST_DEVICE int active(int i) const {
    const int n = view.first[i];
    if (!accelerate.measured || n < 0) return 0;
    int count = 0;
    for (int k = view.begins[n]; k < view.begins[n + 1]; ++k) {
      if (view.entries[k] % 4 == 0 && view.forces[view.entries[k] / 4].normal > 0.0f) ++count;
    }
    return count;
  }
};

}  // namespace pliant
