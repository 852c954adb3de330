#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace pliant {

/// Points sorted into cubes of space, to find those near a box without looking at the others
/// (Teschner et al. 2003, "Optimized spatial hashing for collision detection of deformable
/// objects"). Reused, so that it allocates nothing once it is warm.
class PointHash {
 public:
  /// Cubes of edge `cell` > 0 [m]. Points that are not finite, or more than a billion cells away
  /// from the origin, are left out.
  void build(const Eigen::Matrix3Xd& points, double cell);

  /// Calls visit(point) once for each point whose cube meets the box: all within it, and some near
  /// it. The order depends on nothing but the points. Safe to call from many threads.
  template <class Visit>
  void for_each_near(const Eigen::AlignedBox3d& box, const Visit& visit) const;

 private:
  using Cell = Eigen::Vector3i;
  struct Entry {
    Cell cell;
    int point;
  };

  static constexpr double kFarthest = 1e9;  // cells

  std::size_t bucket(const Cell& cell) const {
    // Large primes spread neighbours (ibid.).
    const auto x = static_cast<std::uint32_t>(cell[0]) * 73856093u;
    const auto y = static_cast<std::uint32_t>(cell[1]) * 19349663u;
    const auto z = static_cast<std::uint32_t>(cell[2]) * 83492791u;
    return (x ^ y ^ z) & mask_;
  }

  double inverse_cell_ = 1.0;                 // [1/m]
  Cell least_ = Cell::Ones();                 // of the cells with points
  Cell largest_ = Cell::Zero();               // likewise; below least_ where there are none
  std::uint32_t mask_ = 0;                    // buckets - 1, a power of two less one
  std::vector<std::size_t> begins_ = {0, 0};  // per bucket, and the end
  std::vector<Entry> entries_;                // bucket by bucket
  std::vector<Entry> unsorted_;
};

template <class Visit>
void PointHash::for_each_near(const Eigen::AlignedBox3d& box, const Visit& visit) const {
  if (!box.min().allFinite() || !box.max().allFinite()) return;
  const Eigen::Array3d lo = (box.min() * inverse_cell_).array().floor();
  const Eigen::Array3d hi = (box.max() * inverse_cell_).array().floor();
  const Cell first = lo.max(least_.cast<double>().array()).min(kFarthest).cast<int>();
  const Cell last = hi.min(largest_.cast<double>().array()).max(-kFarthest).cast<int>();
  if ((last.array() < first.array()).any()) return;
  const Eigen::Array3d cells = (last - first).cast<double>().array() + 1.0;
  if (cells.prod() > static_cast<double>(entries_.size())) {
    for (const Entry& entry : entries_) {
      const bool near =
          (entry.cell.array() >= first.array()).all() && (entry.cell.array() <= last.array()).all();
      if (near) visit(entry.point);
    }
    return;
  }
  Cell cell;
  for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0]) {
    for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1]) {
      for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2]) {
        const std::size_t b = bucket(cell);
        for (std::size_t e = begins_[b]; e < begins_[b + 1]; ++e) {
          if (entries_[e].cell == cell) visit(entries_[e].point);
        }
      }
    }
  }
}

}  // namespace pliant
