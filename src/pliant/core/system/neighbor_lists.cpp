#include "pliant/core/system/neighbor_lists.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <limits>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/widest.h"

namespace pliant {
namespace {

// Bits of a cube's number along each axis. Farther points fall into the last cube: still found,
// with more work.
constexpr int kBits = 20;
constexpr double kLast = (1 << kBits) - 2;
// Cubes for each point, with those that hold none, up to which points are sorted by counting.
constexpr int kMostCubes = 16;
constexpr std::uint64_t kEnd = std::numeric_limits<std::uint64_t>::max();
constexpr int kCellsInPart = 16;
// Looked at one by one from where the last search ended.
constexpr int kNearCells = 6;

// From 1, so that a cube's lower neighbours have keys as well.
std::uint64_t coordinate(double cells) {
  // Not a number fails both comparisons.
  return cells > 0.0 ? 1 + static_cast<std::uint64_t>(cells < kLast ? cells : kLast) : 1;
}

std::uint64_t key_of(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return x | (y << (kBits + 1)) | (z << (2 * (kBits + 1)));
}

/// Those that key_of() was given.
std::array<std::uint64_t, 3> coordinates_of(std::uint64_t key) {
  constexpr std::uint64_t mask = (std::uint64_t{1} << (kBits + 1)) - 1;
  return {key & mask, (key >> (kBits + 1)) & mask, key >> (2 * (kBits + 1))};
}

/// Coordinates of points by rank.
struct Columns {
  const double *x, *y, *z;
};

/// Appends to the `count` ranks of `list` those in [first, last), but for `own`, whose points are
/// nearer to `point` than the root of `largest`. Returns how many there are. The list has place
/// for all.
PLIANT_WIDEST int list_near(const Columns& columns, int first, int last, const double* point,
                            double largest, int own, int* list, int count) {
  constexpr int kBlock = 32;
  double squared[kBlock];
  for (int begin = first; begin < last; begin += kBlock) {
    const int size = std::min(kBlock, last - begin);
    for (int k = 0; k < size; ++k) {
      const double dx = columns.x[begin + k] - point[0], dy = columns.y[begin + k] - point[1];
      const double dz = columns.z[begin + k] - point[2];
      squared[k] = dx * dx + dy * dy + dz * dz;
    }
    for (int k = 0; k < size; ++k) {
      list[count] = begin + k;
      count += static_cast<int>((squared[k] < largest) & (begin + k != own));
    }
  }
  return count;
}

}  // namespace

void NeighborLists::arrange(const Eigen::Matrix3Xd& points, double radius) {
  radius_ = radius;
  sort(points);
}

void NeighborLists::build(const Eigen::Matrix3Xd& points, double radius) {
  arrange(points, radius);
  const int count = (cells() + kCellsInPart - 1) / kCellsInPart;
  if (static_cast<int>(parts_.size()) < count) parts_.resize(at(count));
  parallel_for(0, count, 1, [&](int begin, int end) {
    for (int p = begin; p < end; ++p) {
      list_part(p, p * kCellsInPart, std::min(cells(), (p + 1) * kCellsInPart));
    }
  });
  begins_.clear();
  begins_.push_back(0);
  for (int p = 0; p < count; ++p) {
    for (int n : parts_[at(p)].counts) begins_.push_back(begins_.back() + at(n));
  }
  lists_.resize(begins_.back());
  parallel_for(0, count, 1, [&](int begin, int end) {
    for (int p = begin; p < end; ++p) {
      const int first = cells_[at(p * kCellsInPart)].first;
      std::copy(parts_[at(p)].lists.begin(), parts_[at(p)].lists.end(),
                lists_.begin() + static_cast<std::ptrdiff_t>(begins_[at(first)]));
    }
  });
}

bool NeighborLists::sort_by_counting(const std::array<std::uint64_t, 3>& most) {
  // Factors are below 2^21, so that the product is a number.
  const std::uint64_t cubes = most[0] * most[1] * most[2];
  if (cubes > kMostCubes * entries_.size()) return false;
  counts_.assign(static_cast<std::size_t>(cubes) + 1, 0);
  const auto cube = [&most](std::uint64_t key) {
    const auto [x, y, z] = coordinates_of(key);
    return static_cast<std::size_t>((x - 1) + most[0] * ((y - 1) + most[1] * (z - 1)));
  };
  for (const Entry& entry : entries_) ++counts_[cube(entry.key) + 1];
  for (std::size_t c = 1; c < counts_.size(); ++c) counts_[c] += counts_[c - 1];
  sorted_.resize(entries_.size());
  // In the order of points, which stays within a cube.
  for (const Entry& entry : entries_) sorted_[at(counts_[cube(entry.key)]++)] = entry;
  entries_.swap(sorted_);
  return true;
}

void NeighborLists::sort_by_comparing() {
  const auto before = [](const Entry& a, const Entry& b) {
    return a.key != b.key ? a.key < b.key : a.point < b.point;
  };
  if (threads() == 1) {
    std::sort(entries_.begin(), entries_.end(), before);
  } else {
    tbb::parallel_sort(entries_.begin(), entries_.end(), before);
  }
}

void NeighborLists::sort(const Eigen::Matrix3Xd& points) {
  const int n = static_cast<int>(points.cols());
  origin_ = n > 0 ? Eigen::Vector3d(points.rowwise().minCoeff()) : Eigen::Vector3d::Zero();
  const double scale = 1.0 / radius_;
  entries_.resize(at(n));
  std::array<std::uint64_t, 3> most{};
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d cells = scale * (points.col(i) - origin_);
    const std::array<std::uint64_t, 3> own = {coordinate(cells[0]), coordinate(cells[1]),
                                              coordinate(cells[2])};
    for (std::size_t d = 0; d < 3; ++d) most[d] = std::max(most[d], own[d]);
    entries_[at(i)] = {key_of(own[0], own[1], own[2]), i};
  }
  if (!sort_by_counting(most)) sort_by_comparing();
  order_.resize(at(n));
  for (auto* values : {&x_, &y_, &z_}) values->resize(at(n));
  cells_.clear();
  for (int k = 0; k < n; ++k) {
    const Entry& entry = entries_[at(k)];
    if (k == 0 || entry.key != entries_[at(k - 1)].key) cells_.push_back({entry.key, k});
    order_[at(k)] = entry.point;
    x_[at(k)] = points(0, entry.point);
    y_[at(k)] = points(1, entry.point);
    z_[at(k)] = points(2, entry.point);
  }
  cells_.push_back({kEnd, n});
}

NeighborLists::Cell NeighborLists::cell(int number) const {
  const auto [x, y, z] = coordinates_of(cells_[at(number)].key);
  return {static_cast<int>(x) - 1, static_cast<int>(y) - 1, static_cast<int>(z) - 1};
}

int NeighborLists::cell_from(std::uint64_t key, int hint) const {
  // There, a few on, or anywhere.
  const bool is_below = hint == 0 || cells_[at(hint - 1)].key < key;
  int first = is_below ? hint : 0;
  const int last = std::min(first + kNearCells, cells());
  while (first < last && cells_[at(first)].key < key) ++first;
  if (cells_[at(first)].key >= key) return first;
  const auto found =
      std::lower_bound(cells_.begin() + first, cells_.end() - 1, key,
                       [](const CellStart& c, std::uint64_t k) { return c.key < k; });
  return static_cast<int>(found - cells_.begin());
}

NeighborLists::Rows NeighborLists::rows_about(const Cell& cell, RowHints& hints) const {
  Rows rows{};
  const int last = static_cast<int>(kLast);
  for (int r = 0; r < 9; ++r) {
    const int y = cell[1] + r % 3 - 1, z = cell[2] + r / 3 - 1;
    if (y < 0 || z < 0 || y > last || z > last || cell[0] < -1 || cell[0] > last + 1) continue;
    const auto key = [&](int x) {
      return key_of(static_cast<std::uint64_t>(x + 1), static_cast<std::uint64_t>(y + 1),
                    static_cast<std::uint64_t>(z + 1));
    };
    const int begin = cell_from(key(std::max(0, cell[0] - 1)), hints.cells[at(r)]);
    const int end = cell_from(key(cell[0] + 1) + 1, begin);
    hints.cells[at(r)] = begin;
    rows[at(r)] = {cells_[at(begin)].first, cells_[at(end)].first};
  }
  return rows;
}

void NeighborLists::list_part(int part, int first_cell, int last_cell) {
  Part& own = parts_[at(part)];
  own.lists.clear();
  own.counts.clear();
  const double largest = radius_ * radius_;
  const Columns columns = {x_.data(), y_.data(), z_.data()};
  std::size_t used = 0;
  RowHints hints;
  for (int c = first_cell; c < last_cell; ++c) {
    const Rows rows = rows_about(cell(c), hints);
    std::size_t most = 0;
    for (const auto& row : rows) most += at(row[1] - row[0]);
    for (int k = cells_[at(c)].first; k < cells_[at(c + 1)].first; ++k) {
      if (own.lists.size() < used + most) own.lists.resize(2 * (used + most));
      int* const list = own.lists.data() + used;
      const double point[] = {x_[at(k)], y_[at(k)], z_[at(k)]};
      int count = 0;
      for (const auto& row : rows) {
        count = list_near(columns, row[0], row[1], point, largest, k, list, count);
      }
      used += at(count);
      own.counts.push_back(count);
    }
  }
  own.lists.resize(used);
}

}  // namespace pliant
