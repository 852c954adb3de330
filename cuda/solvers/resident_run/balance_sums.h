#pragma once

#include "cuda/solvers/resident_run/balance_search.h"

/// What a component's balance needs of its members, summed in a fixed order.
namespace pliant {

/// Of each run of a component's members, by a block of its own. Before, moves them by the motion
/// that was found last, and contacts take the forces with which they answer it.
struct SumMembers {
  enum Stage : int {
    kStart,    ///< before the iterations, where something touches
    kEnded,    ///< where the iterations came
    kMoved,    ///< once more, after the first motion
    kCompared  ///< after the second one: what is left belongs to velocities
  };
  static constexpr int kThreads = BalanceComponents::kRun;
  static constexpr int kHalvings = BalanceComponents::kHalvings;
  static constexpr int kPhases = kHalvings + 2;
  static constexpr int kNumbers = BalanceComponents::kNumbers;
  static constexpr int kSharedFloats = kThreads * (2 * kNumbers + 1);

  StepArrays arrays;
  ResidentArrays resident;
  BalanceComponents components;
  Fixed* x;
  Stage stage;
  float softness;  ///< of the contacts (BalanceContacts)

  PLIANT_HOST_DEVICE void operator()(int phase, int run, int thread, float* shared) const {
    auto* sums = reinterpret_cast<double*>(shared);
    auto* touches = reinterpret_cast<int*>(shared + 2 * kNumbers * kThreads);
    if (phase == 0) {
      for (int k = 0; k < kNumbers; ++k) sums[thread * kNumbers + k] = 0.0;
      touches[thread] = 0;
      const int i = member(run, thread);
      if (i >= 0 && is_due(i)) touches[thread] = add(run, i, sums + thread * kNumbers);
      sums[thread * kNumbers + BalanceComponents::kTouched] = touches[thread];
    } else if (phase <= kHalvings) {
      SumAnswers::halve(sums, phase, thread, kNumbers);
    } else {
      if (thread < kNumbers) components.sums[run * kNumbers + thread] = sums[thread];
      if (thread == 0) list(run, touches);
    }
  }

 private:
  // As MomentumBalance: below that share of Coulomb's bound friction holds its point.
  static constexpr float kSticks = 1.0f - 1e-5f;

  PLIANT_HOST_DEVICE BalanceContacts contacts() const {
    return {arrays, resident, components, x, softness};
  }
  PLIANT_HOST_DEVICE int member(int run, int thread) const {
    const int component = components.of_run[run];
    const int k =
        components.begins[component] + (run - components.run_begins[component]) * kThreads + thread;
    return k < components.begins[component + 1] ? components.members[k] : -1;
  }
  PLIANT_HOST_DEVICE bool is_due(int i) const {
    const int number = scene_of(arrays, i);
    const SceneState scene = arrays.scene(number);
    if (!scene.rules.is_due) return false;
    if (stage == kStart) return resident.tally[number].touches != 0;
    return scene.control.result != StepControl::kNotFinite;
  }
  PLIANT_HOST_DEVICE void list(int run, const int* touches) const {
    int count = 0;
    for (int t = 0; t < kThreads; ++t) {
      if (touches[t] != 0) components.touched[run * kThreads + count++] = member(run, t);
    }
    components.touched_count[run] = count;
  }

  /// Returns whether it has contacts.
  PLIANT_HOST_DEVICE int add(int run, int i, double* to) const {
    const int number = scene_of(arrays, i), component = components.of_run[run];
    const double quantum = arrays.rules[number].quantum;
    const Fixed origin = resident.now[components.first_of(component)];
    place(i, component, quantum);
    const double m = resident.now[i].w;
    const Double3 q = quantum * difference(x[i], origin);
    const Double3 added = in_double(
        added_displacement(resident, resident.rules[number], static_cast<float>(quantum), i));
    // Of what rounding took from the prediction velocities know already.
    const Double3 to_prediction = difference(resident.predicted[i], x[i]);
    const Double3 force = (m * quantum) * to_prediction;
    const Double3 moved =
        quantum * (difference(x[i], resident.now[i]) + in_double(resident.left[i].xyz()));
    to[BalanceComponents::kMass] = m;
    write(m * q, to + BalanceComponents::kFirst);
    const double second[6] = {q.x * q.x, q.y * q.y, q.z * q.z, q.x * q.y, q.x * q.z, q.y * q.z};
    for (int k = 0; k < 6; ++k) to[BalanceComponents::kSecond + k] = m * second[k];
    write(force, to + BalanceComponents::kForce);
    write(cross(q, force), to + BalanceComponents::kTorque);
    to[BalanceComponents::kSize] = norm(force);
    to[BalanceComponents::kMoved] =
        m * (squared_norm(moved) + quantum * quantum * squared_norm(added));
    return add_contacts(i, q, force, quantum, to);
  }
  PLIANT_HOST_DEVICE static void write(const Double3& v, double* to) {
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
  }
  PLIANT_HOST_DEVICE void place(int i, int component, double quantum) const {
    if (stage == kEnded) {
      x[i] = arrays.ended(arrays.scene(scene_of(arrays, i)).control, i);
    } else if (stage != kStart) {
      const BalanceMotion motion = components.searches[component].found();
      contacts().take(motion, i);
      x[i] = moved_far(x[i], (1.0 / quantum) * motion.far(motion.arm(x[i], quantum)));
    }
  }

  PLIANT_HOST_DEVICE int add_contacts(int i, const Double3& q, const Double3& other, double quantum,
                                      double* to) const {
    int any = 0;
    contacts().for_each(i, [&](int at) {
      const DeviceContact& contact = resident.contacts[at];
      any = 1;
      DeviceContactForce& force = resident.forces[at];
      if (stage == kStart || stage == kEnded) components.rows[at] = row(i, contact, force, quantum);
      if (stage == kStart) {
        force = {0.0f, {0.0f, 0.0f, 0.0f}};
        const double out = greater(0.0, -static_cast<double>(components.rows[at].w));
        const Double3 normal = in_double(contact.plane.xyz());
        to[BalanceComponents::kAlone] += out * (0.5 * resident.now[i].w * out - dot(other, normal));
      }
      const Double3 f = in_double(force.normal * contact.plane.xyz() + force.friction);
      const Double3 torque = cross(q, f);
      const double values[6] = {f.x, f.y, f.z, torque.x, torque.y, torque.z};
      for (int n = 0; n < 6; ++n) to[BalanceComponents::kPushed + n] += values[n];
      to[BalanceComponents::kSize] += norm(f);
    });
    return any;
  }
  /// After the iterations what a contact carries is what holds it where it is.
  PLIANT_HOST_DEVICE Float4 row(int i, const DeviceContact& contact,
                                const DeviceContactForce& force, double quantum) const {
    const Double3 normal = in_double(contact.plane.xyz());
    const Double3 displacement = quantum * difference(x[i], resident.predicted[i]);
    const Double3 slip = in_double(contact.slip.xyz()) + displacement;
    double gap = contact.plane.w + dot(normal, displacement);
    Double3 tangential = slip - dot(normal, slip) * normal;
    if (stage == kEnded) {
      gap = force.normal > 0.0f ? 0.0 : greater(0.0, gap);
      if (norm(force.friction) < kSticks * contact.slip.w * force.normal) {
        tangential = Double3{0.0, 0.0, 0.0};
      }
    }
    return with_w(in_single(tangential), static_cast<float>(gap));
  }
};

/// Moves the members by the motion that was found last, before the iterations: these find the
/// forces of contacts themselves.
struct MoveMembers {
  StepArrays arrays;
  ResidentArrays resident;
  BalanceComponents components;
  Fixed* x;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int component = resident.component[i];
    if (component < 0) return;
    const int number = scene_of(arrays, i);
    if (!arrays.rules[number].is_due || resident.tally[number].touches == 0) return;
    const double quantum = arrays.rules[number].quantum;
    const BalanceMotion motion = components.searches[component].found();
    x[i] = moved_far(x[i], (1.0 / quantum) * motion.far(motion.arm(x[i], quantum)));
    for (int k = 0; k < resident.slots; ++k) {
      resident.forces[resident.slots * i + k] = {0.0f, {0.0f, 0.0f, 0.0f}};
    }
  }
};

}  // namespace pliant
