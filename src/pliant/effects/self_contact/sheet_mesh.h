#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/effects/self_contact/sheet_pairs.h"

namespace pliant {

/// Positions as plain places [m].
inline const Double3* places_in(const Positions& x) {
  static_assert(sizeof(Double3) == 3 * sizeof(double), "columns lie side by side");
  return reinterpret_cast<const Double3*>(x.data());
}

/// The simplices of a sheet at rest, and who is joined to whom.
struct SheetMesh {
  /// `rest` 3 x n [m], all of `triangles`' vertices.
  SheetMesh(const Positions& rest, const Eigen::Matrix3Xi& triangles);

  std::vector<Double3> rest;  ///< [m]
  Eigen::Matrix3Xi triangles;
  Eigen::Matrix2Xi edges;
  std::vector<int> begins;     ///< of each vertex's neighbours, and the end
  std::vector<int> neighbors;  ///< that an edge joins, ascending
  std::vector<int> pieces;     ///< that edges join; of vertices
  double mean_edge = 0.0;      ///< [m]

  /// Some numbers, ascending.
  struct Numbers {
    const int* first;
    const int* last;
    const int* begin() const { return first; }
    const int* end() const { return last; }
  };

  int vertices() const { return static_cast<int>(rest.size()); }
  /// That have a vertex.
  Numbers triangles_of(int vertex) const { return triangles_of_.row(vertex); }
  Numbers edges_of(int vertex) const { return edges_of_.row(vertex); }
  SheetJoints joints() const { return {rest.data(), begins.data(), neighbors.data()}; }

 private:
  /// Of each vertex the simplices that have it.
  struct Rows {
    std::vector<int> begins, numbers;
    Numbers row(int vertex) const {
      const auto k = static_cast<std::size_t>(vertex);
      return {numbers.data() + begins[k], numbers.data() + begins[k + 1]};
    }
  };
  template <int kCorners>
  Rows rows_of(const Eigen::Matrix<int, kCorners, Eigen::Dynamic>& simplices) const;
  void take_edges();
  void label_pieces();

  Rows triangles_of_, edges_of_;
};

/// The least distance that pairs of a sheet keep: of simplices that an edge joins it is less than
/// `thickness` [m].
double least_thickness(const SheetMesh& mesh, double thickness);

}  // namespace pliant
