#pragma once

#include "pliant/math/host_device.h"

namespace pliant {

/// A 3x3 matrix, row by row. A plain struct: it lives in registers of CPU and GPU alike.
template <typename T>
struct Matrix3 {
  T m[9];

  PLIANT_HOST_DEVICE T operator()(int i, int j) const { return m[3 * i + j]; }
  PLIANT_HOST_DEVICE T& operator()(int i, int j) { return m[3 * i + j]; }
};

/// w + x i + y j + z k.
template <typename T>
struct Quaternion {
  T w, x, y, z;

  PLIANT_HOST_DEVICE static Quaternion identity() { return {T(1), T(0), T(0), T(0)}; }
};

template <typename T>
PLIANT_HOST_DEVICE inline T dot(const Quaternion<T>& a, const Quaternion<T>& b) {
  return (a.w * b.w + a.x * b.x) + (a.y * b.y + a.z * b.z);
}

template <typename T>
PLIANT_HOST_DEVICE inline Quaternion<T> operator*(T s, const Quaternion<T>& q) {
  return {s * q.w, s * q.x, s * q.y, s * q.z};
}

/// The rotation `b` followed by the rotation `a`.
template <typename T>
PLIANT_HOST_DEVICE inline Quaternion<T> operator*(const Quaternion<T>& a, const Quaternion<T>& b) {
  return {(a.w * b.w - a.x * b.x) - (a.y * b.y + a.z * b.z),
          (a.w * b.x + a.x * b.w) + (a.y * b.z - a.z * b.y),
          (a.w * b.y + a.y * b.w) + (a.z * b.x - a.x * b.z),
          (a.w * b.z + a.z * b.w) + (a.x * b.y - a.y * b.x)};
}

/// |q|² R, where R is the rotation of q / |q|; the rotation itself when q has unit length.
template <typename T>
PLIANT_HOST_DEVICE inline Matrix3<T> to_matrix(const Quaternion<T>& q) {
  const T ww = q.w * q.w, xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
  const T wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  const T xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
  return {{(ww + xx) - (yy + zz), T(2) * (xy - wz), T(2) * (xz + wy),  //
           T(2) * (xy + wz), (ww + yy) - (xx + zz), T(2) * (yz - wx),  //
           T(2) * (xz - wy), T(2) * (yz + wx), (ww + zz) - (xx + yy)}};
}

/// AᵀB.
template <typename T>
PLIANT_HOST_DEVICE inline Matrix3<T> transpose_times(const Matrix3<T>& a, const Matrix3<T>& b) {
  Matrix3<T> c;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      c(i, j) = a(0, i) * b(0, j) + a(1, i) * b(1, j) + a(2, i) * b(2, j);
    }
  }
  return c;
}

}  // namespace pliant
