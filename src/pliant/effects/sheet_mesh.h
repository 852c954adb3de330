#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/particles.h"
#include "pliant/effects/sheet_pairs.h"

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

  int vertices() const { return static_cast<int>(rest.size()); }
  SheetJoints joints() const { return {rest.data(), begins.data(), neighbors.data()}; }

 private:
  void take_edges();
  void label_pieces();
};

}  // namespace pliant
