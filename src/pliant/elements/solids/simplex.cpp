#include "pliant/elements/solids/simplex.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "pliant/elements/coloring.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

void check_stiffness(const std::string& name, const Eigen::VectorXd& stiffness,
                     Eigen::Index tetrahedra) {
  if (stiffness.size() != tetrahedra) {
    throw InputError(fmt::format("{}: {} values of stiffness for {} tetrahedra; give one each",
                                 name, stiffness.size(), tetrahedra));
  }
  for (Eigen::Index t = 0; t < tetrahedra; ++t) {
    if (std::isfinite(stiffness[t]) && stiffness[t] > 0.0) continue;
    throw InputError(fmt::format("{} {}: stiffness is {} Pa, but must be positive and finite", name,
                                 t, stiffness[t]));
  }
}

}  // namespace

template <int D>
Eigen::Matrix<double, D, D + 1> shape_gradients(const Eigen::Matrix<double, D, D>& sides) {
  Eigen::Matrix<double, D, D + 1> shape;
  shape.template rightCols<D>() = sides.inverse().transpose();
  shape.col(0) = -shape.template rightCols<D>().rowwise().sum();
  return shape;
}

template <int D>
Simplices<D> color_simplices(const std::vector<Simplex<D>>& elements, int particles) {
  std::vector<int> vertices;
  vertices.reserve(elements.size() * (D + 1));
  for (const Simplex<D>& element : elements) {
    vertices.insert(vertices.end(), element.vertices.begin(), element.vertices.end());
  }
  Coloring coloring = color_elements(vertices, D + 1, particles);
  Simplices<D> result;
  result.begins = std::move(coloring.begins);
  result.order = std::move(coloring.order);
  result.elements.reserve(elements.size());
  for (int e : result.order) result.elements.push_back(elements[static_cast<std::size_t>(e)]);
  return result;
}

Simplices<3> make_tetrahedra(const std::string& name, const TetrahedralMesh& rest,
                             const Eigen::VectorXd& stiffness, int first_particle) {
  validate(rest, name);
  check_stiffness(name, stiffness, rest.tetrahedra.cols());
  if (first_particle < 0) {
    throw InputError(
        fmt::format("{}: first particle is {}, but must not be negative", name, first_particle));
  }
  const Eigen::VectorXd volume = volumes(rest);
  std::vector<Simplex<3>> elements(static_cast<std::size_t>(volume.size()));
  for (std::size_t t = 0; t < elements.size(); ++t) {
    const auto column = static_cast<Eigen::Index>(t);
    Simplex<3>& element = elements[t];
    for (std::size_t k = 0; k < 4; ++k) {
      element.vertices[k] = first_particle + rest.tetrahedra(static_cast<Eigen::Index>(k), column);
    }
    Eigen::Matrix3d sides;
    for (Eigen::Index k = 0; k < 3; ++k) {
      sides.col(k) = rest.vertices.col(rest.tetrahedra(k + 1, column)) -
                     rest.vertices.col(rest.tetrahedra(0, column));
    }
    element.shape = shape_gradients<3>(sides);
    element.weight = stiffness[column] * volume[column];
  }
  return color_simplices<3>(elements, first_particle + static_cast<int>(rest.vertices.cols()));
}

template Eigen::Matrix<double, 2, 3> shape_gradients<2>(const Eigen::Matrix2d&);
template Eigen::Matrix<double, 3, 4> shape_gradients<3>(const Eigen::Matrix3d&);
template Simplices<2> color_simplices<2>(const std::vector<Simplex<2>>&, int);
template Simplices<3> color_simplices<3>(const std::vector<Simplex<3>>&, int);

}  // namespace pliant
