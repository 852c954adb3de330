#pragma once

#include <cmath>

#include "pliant/math/host_device.h"

namespace pliant {

/// Plain vectors of single precision, alike on CPU and GPU.
struct Float3 {
  float x, y, z;
};

/// One load or store of 16 bytes.
struct alignas(16) Float4 {
  float x, y, z, w;

  PLIANT_HOST_DEVICE Float3 xyz() const { return {x, y, z}; }
};

struct alignas(16) Int4 {
  int v[4];
};

struct alignas(8) UShort4 {
  unsigned short v[4];
};

PLIANT_HOST_DEVICE inline Float3 operator+(Float3 a, Float3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
PLIANT_HOST_DEVICE inline Float3 operator-(Float3 a, Float3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
PLIANT_HOST_DEVICE inline Float3 operator*(float s, Float3 a) {
  return {s * a.x, s * a.y, s * a.z};
}
PLIANT_HOST_DEVICE inline Float3& operator+=(Float3& a, Float3 b) { return a = a + b; }
PLIANT_HOST_DEVICE inline Float3& operator-=(Float3& a, Float3 b) { return a = a - b; }
PLIANT_HOST_DEVICE inline float dot(Float3 a, Float3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
PLIANT_HOST_DEVICE inline float norm(Float3 a) { return sqrtf(dot(a, a)); }
PLIANT_HOST_DEVICE inline Float3 cross(Float3 a, Float3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
PLIANT_HOST_DEVICE inline Float4 with_w(Float3 a, float w) { return {a.x, a.y, a.z, w}; }

}  // namespace pliant
