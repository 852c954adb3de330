#pragma once

#include "cuda/solvers/contact/embedded_contacts.h"
#include "cuda/solvers/gradient_step.h"
#include "cuda/solvers/matrix/packed_matrix.h"

/// An iteration of GaussSeidelSolver after PullStep, as functions of one thread: A d = r by one
/// sweep from d = 0, x += d, then contacts. PullStep leaves D⁻¹ r, which is d of the first colour.
namespace pliant {

/// One colour, or the overflow: none of its members reads another one.
struct SweepLevel {
  StepArrays arrays;
  MatrixView matrix;
  int first;  ///< row

  PLIANT_HOST_DEVICE void operator()(int k) const {
    constexpr int kUnroll = PackedMatrix::kSweepUnroll, kSlice = SlicedRowsLayout::kSlice;
    const int row = first + k, i = matrix.members[row];
    if (i < 0 || arrays.scene_with(i / arrays.block).control.done_at >= 0) return;
    Float3 sum = {0.0f, 0.0f, 0.0f};
    const int end = sliced_end(matrix.rows.begins, row);
    for (int e = sliced(matrix.rows.begins, row); e < end; e += kUnroll * kSlice) {
      Float4 d[kUnroll];
      for (int u = 0; u < kUnroll; ++u) {
        d[u] = matrix.correction[matrix.rows.neighbors[e + kSlice * u]];
      }
      for (int u = 0; u < kUnroll; ++u) sum += matrix.rows.b[e + kSlice * u] * d[u].xyz();
    }
    matrix.correction[i] = with_w(matrix.correction[i].xyz() - arrays.mobility[i] * sum, 0.0f);
  }
};

/// As touch(), for a displacement `u` from the prediction that knows the contacts' forces already:
/// corrects both.
PLIANT_HOST_DEVICE inline void touch_again(const ContactsView& view, int number, float mobility,
                                           Float3& u) {
  const int begin = view.begins[number], end = view.begins[number + 1];
  for (int k = begin; k < end; ++k) {
    const int c = view.entries[k] / 4;
    const Float4 plane = view.contacts[c].plane;
    const float before = view.forces[c].normal;
    const float wanted = before - (plane.w + dot(plane.xyz(), u)) / mobility;
    view.forces[c].normal = wanted > 0.0f ? wanted : 0.0f;
    u += (mobility * (view.forces[c].normal - before)) * plane.xyz();
  }
  for (int k = begin; k < end; ++k) {
    const int c = view.entries[k] / 4;
    const Float4 plane = view.contacts[c].plane, start = view.contacts[c].slip;
    const Float3 before = view.forces[c].friction;
    Float3 slip = start.xyz() + u;
    slip -= dot(plane.xyz(), slip) * plane.xyz();
    const float bound = start.w * view.forces[c].normal;
    const Float3 force = within_disk(before - (1.0f / mobility) * slip, bound);
    view.forces[c].friction = force;
    u += mobility * (force - before);
  }
}

/// x += d with contacts; of scenes with contacts whose points share particles up to these, with
/// what they need in raw and pushed.
struct LandSweep {
  Acceleration iteration;
  ContactsView contacts;
  MatrixView matrix;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const StepArrays& arrays = iteration.arrays;
    const SceneState scene = arrays.scene_with(i / arrays.block);
    if (scene.control.done_at >= 0) return;
    const Fixed at = iteration.source(scene.control)[i];
    const float quantum = scene.rules.quantum, mobility = arrays.mobility[i];
    const Float3 d = matrix.correction[i].xyz();
    if (scene.rules.embedded) {
      // Without the forces that d knows: they are found from there.
      int active;
      const Float3 known = mobility * contact_force(contacts, i, active);
      arrays.raw[i] = arrays.pushed[i] = moved(at, (1.0f / quantum) * (d - known));
      return;
    }
    Fixed next = moved(at, (1.0f / quantum) * d);
    const int number = contacts.any && mobility > 0.0f ? contacts.first[i] : -1;
    if (number >= 0) {
      const Float3 from = quantum * (next - arrays.predicted[i]);
      Float3 u = from;
      touch_again(contacts, number, mobility, u);
      next = moved(next, (1.0f / quantum) * (u - from));
    }
    land(iteration, scene, i, next);
  }
};

/// The rest of an iteration with contacts of embedded points.
struct LandCarried {
  Acceleration iteration;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const StepArrays& arrays = iteration.arrays;
    const SceneState scene = arrays.scene_with(i / arrays.block);
    if (scene.control.done_at >= 0 || !scene.rules.embedded) return;
    land(iteration, scene, i, arrays.pushed[i]);
  }
};

}  // namespace pliant
