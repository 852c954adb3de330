#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "pliant/geometry/distance/distance_grid.h"

namespace pliant {

/// The body-centred cubic lattice on every other sample of a distance grid of at most 2^31 - 1
/// samples. A lattice point is a sample whose coordinates are all even (a cube's corner) or all
/// odd (its centre), so that a cube is two spacings wide; it is named by its sample's index. An
/// edge is long (between two corners or two centres, along an axis) or short (between a corner and
/// a centre). Four points make a tetrahedron: two neighbouring centres and the ends of an edge of
/// the square between their cubes.
class Lattice {
 public:
  /// The grid must outlive the lattice.
  explicit Lattice(const DistanceGrid& grid);

  /// All points that have all their neighbours, ascending.
  std::vector<int> inner_points() const;

  /// A point's 14 neighbours: 8 along short edges, then 6 along long ones.
  static constexpr int kNeighbours = 14;
  static constexpr int kShortNeighbours = 8;
  int neighbour(int point, int k) const { return point + steps_[static_cast<std::size_t>(k)]; }

  /// The tetrahedra about inner centres for which `wanted(points)` is true, given to
  /// `visit(points)` as centre, centre, corner, corner: the first two and the last two are the ends
  /// of its long edges.
  template <typename Wanted, typename Visit>
  void visit_tetrahedra(const Wanted& wanted, const Visit& visit) const;

  Eigen::Array3i coordinates(int point) const;
  Eigen::Vector3d position(int point) const {
    return grid_->origin + grid_->spacing * coordinates(point).cast<double>().matrix();
  }
  /// Signed distance [m], negative inside.
  double distance(int point) const {
    return static_cast<double>(grid_->samples[static_cast<std::size_t>(point)]);
  }
  /// Whether an edge is long.
  bool is_long(int a, int b) const { return (coordinates(a) - coordinates(b)).abs().sum() == 2; }

 private:
  const DistanceGrid* grid_;
  std::array<int, 3> stride_;  ///< between samples along x, y, z
  std::array<int, kNeighbours> steps_;
};

template <typename Wanted, typename Visit>
void Lattice::visit_tetrahedra(const Wanted& wanted, const Visit& visit) const {
  // Corners of the square between two cubes, around it.
  constexpr int kAround[5][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}};
  for (const int centre : inner_points()) {
    if (coordinates(centre)[0] % 2 == 0) continue;  // a corner
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int u = stride_[(axis + 1) % 3], v = stride_[(axis + 2) % 3];
      const int middle = centre + stride_[axis];
      for (int k = 0; k < 4; ++k) {
        const auto& from = kAround[k];
        const auto& to = kAround[k + 1];
        const std::array<int, 4> points = {centre, middle + stride_[axis],
                                           middle + from[0] * u + from[1] * v,
                                           middle + to[0] * u + to[1] * v};
        if (wanted(points)) visit(points);
      }
    }
  }
}

}  // namespace pliant
