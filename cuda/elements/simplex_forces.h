#pragma once

#include "cuda/core/vector.h"
#include "pliant/laws/corotated.h"
#include "pliant/laws/fiber.h"
#include "pliant/laws/membrane.h"
#include "pliant/math/matrix3.h"

/// Forces of single triangles and tetrahedra in single precision, by the laws that the CPU's
/// element sets follow (pliant/laws).
namespace pliant {

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

/// f_a = -w P g_a.
PLIANT_HOST_DEVICE inline Columns3 tetrahedron_forces(const Matrix3<float>& g,
                                                      const TetrahedronShape& element,
                                                      const Quaternion<float>& rotation) {
  Matrix3<float> p = corotated_stress(g, to_matrix(rotation), element.ratio);
  for (float& entry : p.m) entry *= element.weight;
  return forces_of(p, element.shape);
}

/// Of a fibre along the first rest axis of `shape`.
PLIANT_HOST_DEVICE inline Columns3 fiber_forces(const Columns3& sides, const Columns3& shape,
                                                float weight) {
  const Matrix3<float> g = gradient_of(sides, shape);
  const auto column = [&](int j) { return Float3{g(0, j), g(1, j), g(2, j)}; };
  const Float3 stress = weight * fiber_stress(column(0), column(1), column(2));
  Columns3 f;
  for (int a = 0; a < 3; ++a) f.c[a] = (-shape.c[a].x) * stress;
  return f;
}

/// A triangle's forces on its vertices 1 and 2; `sides` and the rest gradients (2 numbers each) of
/// those vertices, `area` its weight.
struct TriangleForces {
  Float3 f1, f2;
};
PLIANT_HOST_DEVICE inline TriangleForces triangle_forces(Float3 side1, Float3 side2,
                                                         const Float4& shape, float area,
                                                         const MembraneConstants<float>& m) {
  const Float3 a = shape.x * side1 + shape.z * side2;
  const Float3 b = shape.y * side1 + shape.w * side2;
  const auto [p, q] = membrane_stress(a, b, m);
  return {(-area) * (shape.x * p + shape.y * q), (-area) * (shape.z * p + shape.w * q)};
}

}  // namespace pliant
