#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "pliant/core/parallel/parallel.h"

namespace pliant {

/// Points sorted by the cubes of space that hold them, and for each the others within a radius: a
/// compact grid, which costs memory only where there are points. The same for any number of
/// threads; reused, so that it allocates nothing once it is warm.
///
/// Points are numbered anew in the order of their cubes, x fastest, so that neighbours in space are
/// neighbours in memory: `order()` maps these ranks to the points.
class NeighborLists {
 public:
  /// Lists for each of the `points`, 3 x n [m], the others nearer than `radius` > 0 [m].
  void build(const Eigen::Matrix3Xd& points, double radius);
  /// Sorts them by cubes of that edge and lists nothing: for those who visit cubes.
  void arrange(const Eigen::Matrix3Xd& points, double radius);

  int size() const { return static_cast<int>(order_.size()); }
  double radius() const { return radius_; }
  const std::vector<int>& order() const { return order_; }  ///< the point of each rank
  /// Coordinates of the points along an axis, by rank [m].
  const std::vector<double>& along(int axis) const { return axis == 0 ? x_ : axis == 1 ? y_ : z_; }
  /// The ranks of the neighbours of a rank, the same order every time.
  const int* begin(int rank) const { return lists_.data() + begins_[at(rank)]; }
  const int* end(int rank) const { return lists_.data() + begins_[at(rank) + 1]; }

  /// Calls visit(rank, point) for all points, many at a time.
  template <class Visit>
  void for_each_point(const Visit& visit) const {
    parallel_for(0, size(), kGrain, [&](int first, int last) {
      for (int rank = first; rank < last; ++rank) visit(rank, order_[at(rank)]);
    });
  }
  /// Calls visit(point) for the neighbours of a rank, in the same order every time.
  template <class Visit>
  void for_each_neighbor(int rank, const Visit& visit) const {
    for (const int* other = begin(rank); other != end(rank); ++other) visit(order_[at(*other)]);
  }

  // The cubes, of edge radius().
  using Cell = Eigen::Vector3i;
  /// Ranks [first, second) of the points in three cubes in a row along x, for each of the nine rows
  /// about a cube.
  using Rows = std::array<std::array<int, 2>, 9>;
  int cells() const { return static_cast<int>(cells_.size()) - 1; }
  Cell cell(int number) const;
  int cell_begin(int number) const { return cells_[at(number)].first; }
  Rows rows_about(const Cell& cell) const {
    RowHints hints;
    return rows_about(cell, hints);
  }
  /// Where the rows about a cube were found: those of the next one in order are near.
  struct RowHints {
    std::array<int, 9> cells{};
  };
  Rows rows_about(const Cell& cell, RowHints& hints) const;
  const Eigen::Vector3d& origin() const { return origin_; }  ///< of cube (0, 0, 0) [m]

 private:
  struct Entry {
    std::uint64_t key;
    int point;
  };
  struct CellStart {
    std::uint64_t key;
    int first;  // rank
  };
  struct Part {  // lists of a run of cubes
    std::vector<int> lists, counts;
  };

  static constexpr int kGrain = 256;  // points that a thread takes at once
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  void sort(const Eigen::Matrix3Xd& points);
  /// Sorts entries_ by keys and points, where cubes up to the number `most` along each axis are few
  /// enough to count the points of each; false where they are not.
  bool sort_by_counting(const std::array<std::uint64_t, 3>& most);
  void sort_by_comparing();
  void list_part(int part, int first_cell, int last_cell);
  int cell_from(std::uint64_t key, int hint) const;

  double radius_ = 1.0;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  std::vector<Entry> entries_, sorted_;
  std::vector<int> counts_;  // of points, by cube
  std::vector<int> order_;
  std::vector<double> x_, y_, z_;  // by rank
  std::vector<CellStart> cells_;   // ascending keys; the last one marks the end
  std::vector<Part> parts_;
  std::vector<std::size_t> begins_;
  std::vector<int> lists_;
};

}  // namespace pliant
