#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// How an element's rest coordinates (D of them) map to space: ∂x/∂X.
template <int D>
using Gradient = Eigen::Matrix<double, 3, D>;

/// A tetrahedron (D = 3) or a triangle in space (D = 2) with linear shape functions.
template <int D>
struct Simplex {
  std::array<int, D + 1> vertices;
  Eigen::Matrix<double, D, D + 1> shape;  ///< the shape functions' gradients at rest [1/m]
  double weight = 0.0;                    ///< rest volume or area times stiffness

  /// G = Σₐ xₐ gₐᵀ, from differences, so that a body far from the origin keeps its digits.
  Gradient<D> gradient(const Positions& x) const {
    Eigen::Matrix<double, 3, D> sides;
    for (int k = 0; k < D; ++k) sides.col(k) = x.col(vertices[k + 1]) - x.col(vertices[0]);
    return sides * shape.template rightCols<D>().transpose();
  }

  /// x += scaleₐ · stress gₐ on each vertex a, with scale(a) given its particle.
  template <class Scale>
  void scatter(const Gradient<D>& stress, const Scale& scale, Eigen::Matrix3Xd& x) const {
    for (int a = 0; a <= D; ++a) x.col(vertices[a]) += scale(vertices[a]) * (stress * shape.col(a));
  }
};

/// From the rest positions of the corners, 3 columns of rest coordinates: x₁-x₀, ... as columns.
template <int D>
Eigen::Matrix<double, D, D + 1> shape_gradients(const Eigen::Matrix<double, D, D>& sides);

/// Simplices such that those of one colour share no particle.
template <int D>
struct Simplices {
  std::vector<Simplex<D>> elements;  ///< colour by colour
  std::vector<int> begins;           ///< first element of each colour, and the end
  std::vector<int> order;            ///< their numbers in the mesh
};

/// Puts them into colour order.
template <int D>
Simplices<D> color_simplices(const std::vector<Simplex<D>>& elements, int particles);

/// The tetrahedra of a mesh, weighted by volume times `stiffness` (one a tetrahedron) [J]; the mesh
/// may be part of a system, whose particle `first_particle` is vertex 0. Throws InputError,
/// beginning with `name`, for a mesh that validate() refuses, a stiffness that is not positive and
/// finite, another number of them than tetrahedra, or a negative first particle.
Simplices<3> make_tetrahedra(const std::string& name, const TetrahedralMesh& rest,
                             const Eigen::VectorXd& stiffness, int first_particle = 0);

}  // namespace pliant
