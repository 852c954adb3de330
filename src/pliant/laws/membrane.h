#pragma once

#include "pliant/laws/length.h"

namespace pliant {

/// Stiffnesses of a membrane along its yarns, in shear, and beyond its limits [N/m], and these
/// limits, as shares of the length at rest.
template <typename T>
struct MembraneConstants {
  T warp, weft, shear, limit;
  T warp_min, warp_max, weft_min, weft_max;
};

/// dΨ/d|a| of the terms of one yarn of that length.
template <typename T>
PLIANT_HOST_DEVICE inline T yarn_tension(T length, T stiffness, T limit, T min, T max) {
  const T beyond = length - clamped(length, min, max);
  return stiffness * (length - T(1)) + limit * beyond;
}

/// dΨ/da and dΨ/db.
template <class V>
struct MembraneStress {
  V along_warp, along_weft;
};

/// Of the energy of MembraneLaw (pliant/elements/cloth/membrane_law.h), where warp and weft, of
/// length 1 at rest, became a and b.
template <class V>
PLIANT_HOST_DEVICE inline MembraneStress<V> membrane_stress(
    const V& a, const V& b, const MembraneConstants<NumberOf<V>>& m) {
  using T = NumberOf<V>;
  const T half_root = T(0.70710678118654757);
  const T la = divisor_of(a), lb = divisor_of(b);
  V p = (yarn_tension(la, m.warp, m.limit, m.warp_min, m.warp_max) / la) * a;
  V q = (yarn_tension(lb, m.weft, m.limit, m.weft_min, m.weft_max) / lb) * b;
  // With u, v = (a ± b)/√2: k (|u| - |v|) (û, -v̂), turned back.
  const V u = half_root * (a + b), v = half_root * (a - b);
  const T lu = divisor_of(u), lv = divisor_of(v);
  const T difference = half_root * m.shear * (lu - lv);
  const V nu = u / lu, nv = v / lv;
  p += difference * (nu - nv);
  q += difference * (nu + nv);
  return {p, q};
}

}  // namespace pliant
