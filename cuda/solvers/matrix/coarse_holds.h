#pragma once

#include "cuda/solvers/matrix/quasi_newton_state.h"

/// What contacts hold, on the coarse levels of multigrid. Coarse matrices know nothing of contacts:
/// what they find would be far too long where held particles stop it. So they get a stiffness K in
/// the directions that are held. On places it is κ A_ii there; a coarse row takes Σ_i R_ci K_i with
/// all of its own weight, no less than PᵀK P, since rows of P have no negative entries and a sum
/// of 1. Then no coarse correction is longer than 1 + 2/κ of the best one of its kind: where of
/// w = P v the held part u is lost, (w−u)ᵀA(w−u) <= (1 + ε) wᵀA w + (1 + 1/ε) uᵀA u for any ε, and
/// uᵀA u <= 2 Σ A_ii |u_i|² where no eigenvalue of D⁻¹A is above 2. With κ = 3 that is
/// 5/3, so that no cycle raises an error; random holds leave it below 1. More makes cloth too stiff
/// on curved obstacles.
namespace pliant {

/// xx, yy, zz, xy, xz, yz.
struct Symmetric3 {
  float xx, yy, zz, xy, xz, yz;

  PLIANT_HOST_DEVICE Float3 times(Float3 v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z,
            xz * v.x + yz * v.y + zz * v.z};
  }
  PLIANT_HOST_DEVICE void add(float weight, const Symmetric3& o) {
    xx += weight * o.xx;
    yy += weight * o.yy;
    zz += weight * o.zz;
    xy += weight * o.xy;
    xz += weight * o.xz;
    yz += weight * o.yz;
  }
  /// w v vᵀ and w (1 − v vᵀ).
  PLIANT_HOST_DEVICE static Symmetric3 along(float w, Float3 v) {
    return {w * v.x * v.x, w * v.y * v.y, w * v.z * v.z,
            w * v.x * v.y, w * v.x * v.z, w * v.y * v.z};
  }
  PLIANT_HOST_DEVICE static Symmetric3 across(float w, Float3 v) {
    Symmetric3 result = along(-w, v);
    result.add(w, {1.0f, 1.0f, 1.0f, 0.0f, 0.0f, 0.0f});
    return result;
  }
};

/// K of a coarse row and D (D + K)⁻¹, in three words.
struct CoarseHold {
  // Of the diagonal: beyond that a row does not move anyway, and single precision has to tell what
  // is free from what is held.
  static constexpr float kMost = 1000.0f;

  PLIANT_HOST_DEVICE static Symmetric3 stiffness(const Float4* w) {
    return {w[0].x, w[0].y, w[0].z, w[0].w, w[1].x, w[1].y};
  }
  PLIANT_HOST_DEVICE static Float3 compliant(const Float4* w, Float3 v) {
    const Symmetric3 c = {w[1].z, w[1].w, w[2].x, w[2].y, w[2].z, w[2].w};
    return c.times(v);
  }
  PLIANT_HOST_DEVICE static void store(const Symmetric3& sum, float diagonal, Float4* w) {
    const float trace = sum.xx + sum.yy + sum.zz, most = kMost * diagonal;
    Symmetric3 k = {};
    k.add(trace > most ? most / trace : 1.0f, sum);
    Symmetric3 shares = {};
    shares.add(1.0f / diagonal, k);
    const Symmetric3 c = inverse_beside_one(shares);
    w[0] = {k.xx, k.yy, k.zz, k.xy};
    w[1] = {k.xz, k.yz, c.xx, c.yy};
    w[2] = {c.zz, c.xy, c.xz, c.yz};
  }

 private:
  /// (1 + k)⁻¹ by L D Lᵀ: no pivot is less than 1.
  PLIANT_HOST_DEVICE static Symmetric3 inverse_beside_one(const Symmetric3& k) {
    const auto pivot = [](float value) { return value > 1.0f ? value : 1.0f; };
    const float a = pivot(1.0f + k.xx), ba = k.xy / a, ca = k.xz / a;
    const float d = pivot(1.0f + k.yy - ba * k.xy), cb = (k.yz - ba * k.xz) / d;
    const float f = pivot(1.0f + k.zz - ca * k.xz - cb * cb * d);
    // Columns of L⁻¹: (1, −ba, ba cb − ca), (0, 1, −cb), (0, 0, 1).
    const float m = ba * cb - ca, p = 1.0f / a, q = 1.0f / d, r = 1.0f / f;
    return {p + ba * ba * q + m * m * r, q + cb * cb * r, r, -ba * q - m * cb * r, m * r, -cb * r};
  }
};

/// K of places.
struct HoldsOfPlaces {
  static constexpr float kStiffness = 3.0f;  ///< κ
  const Float4* holds;
  const float* mobility;
  const StepRules& rules;

  PLIANT_HOST_DEVICE void add(int i, float weight, Symmetric3& sum) const {
    const Float4 hold = holds[i];
    const int kind = static_cast<int>(hold.w);
    if (kind == Hold::kFree || mobility[i] == 0.0f) return;
    const float k = kStiffness * static_cast<float>(rules.gamma) / mobility[i];
    if (kind == Hold::kPlane) sum.add(weight, Symmetric3::along(k, hold.xyz()));
    if (kind == Hold::kLine) sum.add(weight, Symmetric3::across(k, hold.xyz()));
    if (kind == Hold::kFixed) sum.add(weight, {k, k, k, 0.0f, 0.0f, 0.0f});
  }
};

/// And of a finer level's rows.
struct HoldsOfRows {
  const Float4* held;

  PLIANT_HOST_DEVICE void add(int i, float weight, Symmetric3& sum) const {
    sum.add(weight, CoarseHold::stiffness(held + 3 * i));
  }
};

}  // namespace pliant
