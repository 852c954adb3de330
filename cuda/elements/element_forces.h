#pragma once

#include "cuda/core/vector.h"
#include "pliant/math/rotation.h"

/// Forces of single elements in single precision, for CPU and GPU from one source. Formulas and
/// limits are those of the element sets of the same names in src/pliant/elements.
namespace pliant {

/// Below this length a vector has no direction and exerts no force.
constexpr float kShortestFloat = 1e-18f;

PLIANT_HOST_DEVICE inline float length_of(Float3 a) {
  const float length = norm(a);
  return length > kShortestFloat ? length : kShortestFloat;
}

/// On particle i of a spring to j, with `way` x_j - x_i: k (|d| - l) d / |d|.
PLIANT_HOST_DEVICE inline Float3 spring_force(Float3 way, float rest_length, float stiffness) {
  return (stiffness * (1.0f - rest_length / length_of(way))) * way;
}

/// On a corner of a cell to the opposite one, with `way` to it and `other` between the two others:
/// k (|d| - |e|) d / |d|.
PLIANT_HOST_DEVICE inline Float3 cell_force(Float3 way, Float3 other, float stiffness) {
  return (stiffness * (1.0f - length_of(other) / length_of(way))) * way;
}

/// Where a search for a rotation begins: a unit quaternion to 15 bits; zero: nobody knows.
struct alignas(8) PackedRotation {
  short v[4];
};

PLIANT_HOST_DEVICE inline PackedRotation packed(const Quaternion<float>& q) {
  constexpr float kOne = 32767.0f;
  const float numbers[4] = {q.w, q.x, q.y, q.z};
  PackedRotation result;
  for (int k = 0; k < 4; ++k) {
    result.v[k] = static_cast<short>(nearest_int(kOne * numbers[k]));
  }
  return result;
}

PLIANT_HOST_DEVICE inline bool is_unknown(const PackedRotation& packed) {
  return (packed.v[0] | packed.v[1] | packed.v[2] | packed.v[3]) == 0;
}

/// Of unit length to 15 bits, which a search does not mind; zero where nobody knows.
PLIANT_HOST_DEVICE inline Quaternion<float> unpacked(const PackedRotation& packed) {
  constexpr float kUnit = 1.0f / 32767.0f;
  const Quaternion<float> q = {static_cast<float>(packed.v[0]), static_cast<float>(packed.v[1]),
                               static_cast<float>(packed.v[2]), static_cast<float>(packed.v[3])};
  return kUnit * q;
}

/// Columns of a 3x3 matrix.
struct Columns3 {
  Float3 c[3];
};

/// The linear map of a tetrahedron's sides x_a - x_0 (columns of `sides`) to stress times rest
/// gradients: forces on its vertices 1 to 3 are the columns of the result, on vertex 0 minus their
/// sum. `shape` holds, for vertices 1 to 3, the gradient of the shape function as a column [1/m].
struct TetrahedronShape {
  Columns3 shape;
  float weight;  ///< s v [J]
  float ratio;   ///< λ/μ
};

/// G = Σₐ (x_a - x_0) g_aᵀ, row by row.
PLIANT_HOST_DEVICE inline Matrix3<float> gradient_of(const Columns3& sides, const Columns3& shape) {
  Matrix3<float> g;
  const float* s = &shape.c[0].x;
  for (int j = 0; j < 3; ++j) {
    g(0, j) = sides.c[0].x * s[j] + sides.c[1].x * s[3 + j] + sides.c[2].x * s[6 + j];
    g(1, j) = sides.c[0].y * s[j] + sides.c[1].y * s[3 + j] + sides.c[2].y * s[6 + j];
    g(2, j) = sides.c[0].z * s[j] + sides.c[1].z * s[3 + j] + sides.c[2].z * s[6 + j];
  }
  return g;
}

/// f_a = -P g_a.
PLIANT_HOST_DEVICE inline Columns3 forces_of(const Matrix3<float>& p, const Columns3& shape) {
  Columns3 f;
  for (int a = 0; a < 3; ++a) {
    const Float3 g = shape.c[a];
    f.c[a] = {-(p(0, 0) * g.x + p(0, 1) * g.y + p(0, 2) * g.z),
              -(p(1, 0) * g.x + p(1, 1) * g.y + p(1, 2) * g.z),
              -(p(2, 0) * g.x + p(2, 1) * g.y + p(2, 2) * g.z)};
  }
  return f;
}

/// Corotated tetrahedron, Ψ' = 2 (G - R) + ρ (R : (G - R)) R.
PLIANT_HOST_DEVICE inline Columns3 tetrahedron_forces(const Matrix3<float>& g,
                                                      const TetrahedronShape& element,
                                                      const Quaternion<float>& rotation) {
  const Matrix3<float> r = to_matrix(rotation);
  float trace = 0.0f;
  for (int k = 0; k < 9; ++k) trace += r.m[k] * (g.m[k] - r.m[k]);
  const float along = element.ratio * trace;
  Matrix3<float> p;
  for (int k = 0; k < 9; ++k) {
    p.m[k] = element.weight * (2.0f * (g.m[k] - r.m[k]) + along * r.m[k]);
  }
  return forces_of(p, element.shape);
}

/// Fibre along the first rest axis of `shape`: the first column of Ψ' is g₀ - g₀/|g₀|.
PLIANT_HOST_DEVICE inline Columns3 fiber_forces(const Columns3& sides, const Columns3& shape,
                                                float weight) {
  const Matrix3<float> g = gradient_of(sides, shape);
  const Float3 g0 = {g(0, 0), g(1, 0), g(2, 0)};
  Float3 along = (1.0f / length_of(g0)) * g0;
  if (norm(g0) < kShortestFloat) {
    // Pressed to a point it springs back along the normal of what lies across it, or else along x.
    const Float3 normal = cross({g(0, 1), g(1, 1), g(2, 1)}, {g(0, 2), g(1, 2), g(2, 2)});
    const bool has_normal = norm(normal) > kShortestFloat;
    along = has_normal ? (1.0f / length_of(normal)) * normal : Float3{1.0f, 0.0f, 0.0f};
  }
  const Float3 stress = weight * (g0 - along);
  Columns3 f;
  for (int a = 0; a < 3; ++a) f.c[a] = (-shape.c[a].x) * stress;
  return f;
}

/// As MembraneMaterial (pliant/elements/cloth/membrane_law.h).
struct MembraneConstants {
  float warp, weft, shear, limit;
  float warp_min, warp_max, weft_min, weft_max;
};

PLIANT_HOST_DEVICE inline float yarn_tension(float length, float stiffness, float limit, float min,
                                             float max) {
  const float within = length < min ? min : (length > max ? max : length);
  return stiffness * (length - 1.0f) + limit * (length - within);
}

/// A triangle's forces on its vertices 1 and 2; `sides` and the rest gradients (2 numbers each) of
/// those vertices, `area` its weight.
struct TriangleForces {
  Float3 f1, f2;
};
PLIANT_HOST_DEVICE inline TriangleForces triangle_forces(Float3 side1, Float3 side2,
                                                         const Float4& shape, float area,
                                                         const MembraneConstants& m) {
  const float kHalfRoot = 0.70710678f;
  const Float3 a = shape.x * side1 + shape.z * side2;
  const Float3 b = shape.y * side1 + shape.w * side2;
  const float la = length_of(a), lb = length_of(b);
  Float3 p = (yarn_tension(la, m.warp, m.limit, m.warp_min, m.warp_max) / la) * a;
  Float3 q = (yarn_tension(lb, m.weft, m.limit, m.weft_min, m.weft_max) / lb) * b;
  const Float3 u = kHalfRoot * (a + b), v = kHalfRoot * (a - b);
  const float lu = length_of(u), lv = length_of(v);
  const float difference = kHalfRoot * m.shear * (lu - lv);
  const Float3 nu = (1.0f / lu) * u, nv = (1.0f / lv) * v;
  p += difference * (nu - nv);
  q += difference * (nu + nv);
  return {(-area) * (shape.x * p + shape.y * q), (-area) * (shape.z * p + shape.w * q)};
}

}  // namespace pliant
