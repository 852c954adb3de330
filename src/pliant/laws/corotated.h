#pragma once

#include "pliant/math/matrix3.h"

namespace pliant {

/// A : B, summed column by column in pairs, as vector registers of two numbers add them.
template <typename T>
PLIANT_HOST_DEVICE inline T double_contraction(const Matrix3<T>& a, const Matrix3<T>& b) {
  const auto term = [&](int i, int j) { return a(i, j) * b(i, j); };
  const T even = (term(0, 0) + term(2, 0)) + (term(1, 1) + term(0, 2));
  const T odd = (term(1, 0) + term(0, 1)) + (term(2, 1) + term(1, 2));
  return (even + odd) + term(2, 2);
}

/// Ψ' of a corotated solid per stiffness μ, with ρ = λ/μ and the rotation R nearest to G:
/// 2 (G − R) + ρ (R : (G − R)) R. Of the difference, which keeps its digits near rest.
template <typename T>
PLIANT_HOST_DEVICE inline Matrix3<T> corotated_stress(const Matrix3<T>& g, const Matrix3<T>& r,
                                                      T ratio) {
  Matrix3<T> strain;
  for (int k = 0; k < 9; ++k) strain.m[k] = g.m[k] - r.m[k];
  const T along = ratio * double_contraction(r, strain);
  Matrix3<T> p;
  for (int k = 0; k < 9; ++k) p.m[k] = T(2) * strain.m[k] + along * r.m[k];
  return p;
}

/// Ψ = |G − R|² + ρ/2 (R : (G − R))².
template <typename T>
PLIANT_HOST_DEVICE inline T corotated_energy(const Matrix3<T>& g, const Matrix3<T>& r, T ratio) {
  Matrix3<T> strain;
  for (int k = 0; k < 9; ++k) strain.m[k] = g.m[k] - r.m[k];
  const T trace = double_contraction(r, strain);
  return double_contraction(strain, strain) + T(0.5) * ratio * trace * trace;
}

}  // namespace pliant
