#pragma once

#include <algorithm>
#include <cmath>

#include "cuda/core/prefix_sums.h"
#include "cuda/core/vector.h"

namespace pliant {

/// Particles sorted by the cubes of space that hold them, in the memory of an executor. Cubes are
/// numbered modulo a power of two along each axis, so that the grid has few of them however far
/// particles fly: what shares a number is told apart by its distance.
struct GridView {
  const int* begins = nullptr;  ///< of each cube's ranks, and the end
  const int* order = nullptr;   ///< the particle of each rank, ascending within a cube
  const Fixed* x = nullptr;     ///< by rank [quanta], and V/H³
  int particles = 0;
  int edge = 1;             ///< of a cube, no less than H [quanta]
  int bits[3] = {1, 1, 1};  ///< cubes along each axis: 1 << bits, at least 4
  float scale = 1.0f;       ///< quantum over H

  PLIANT_HOST_DEVICE int cubes() const { return 1 << (bits[0] + bits[1] + bits[2]); }
  PLIANT_HOST_DEVICE int along(int value, int axis) const {
    const int down = value / edge - (value % edge < 0 ? 1 : 0);
    return down & ((1 << bits[axis]) - 1);
  }
  PLIANT_HOST_DEVICE int row(int y, int z) const {
    const int wy = y & ((1 << bits[1]) - 1), wz = z & ((1 << bits[2]) - 1);
    return ((wz << bits[1]) + wy) << bits[0];
  }
  PLIANT_HOST_DEVICE int cube(const Fixed& at) const {
    return row(along(at.y, 1), along(at.z, 2)) + along(at.x, 0);
  }
};

/// Calls sum(j, s, apart) for the ranks j of all others nearer than H to `rank`, in a fixed order:
/// `apart` x_i − x_j over H, and s its length.
template <class Sum>
PLIANT_HOST_DEVICE inline void sum_near(const GridView& g, int rank, Sum& sum) {
  const Fixed at = g.x[rank];
  const int x = g.along(at.x, 0), y = g.along(at.y, 1), z = g.along(at.z, 2);
  const int last = (1 << g.bits[0]) - 1;
  for (int r = 0; r < 9; ++r) {
    const int row = g.row(y + r % 3 - 1, z + r / 3 - 1);
    // Three cubes side by side, or two and one beyond the end of the row.
    const int low = x > 0 ? x - 1 : 0, high = x < last ? x + 1 : last;
    const int other = x == 0 ? last : (x == last ? 0 : -1);
    for (int part = 0; part < (other < 0 ? 1 : 2); ++part) {
      const int begin = g.begins[row + (part == 0 ? low : other)];
      const int end = g.begins[row + (part == 0 ? high : other) + 1];
      for (int j = begin; j < end; ++j) {
        const Float3 apart = g.scale * (at - g.x[j]);
        const float squared = dot(apart, apart);
        if (squared < 1.0f && j != rank) sum(j, sqrtf(squared), apart);
      }
    }
  }
}

/// One more in a counter; returns how many there were.
PLIANT_HOST_DEVICE inline int count_up(int* counter) {
#ifdef __CUDA_ARCH__
  return atomicAdd(counter, 1);
#else
  return (*counter)++;
#endif
}

namespace grid_kernels {

struct Count {
  GridView grid;
  const Fixed* x;  ///< by particle
  int* counts;
  PLIANT_HOST_DEVICE void operator()(int i) const { count_up(&counts[grid.cube(x[i])]); }
};

/// In any order within a cube; SortCubes puts that right.
struct Scatter {
  GridView grid;
  const Fixed* x;
  int* next;
  int* order;
  PLIANT_HOST_DEVICE void operator()(int i) const { order[count_up(&next[grid.cube(x[i])])] = i; }
};

struct SortCubes {
  const int* begins;
  int* order;
  PLIANT_HOST_DEVICE void operator()(int cube) const {
    const int begin = begins[cube], end = begins[cube + 1];
    for (int k = begin + 1; k < end; ++k) {
      const int i = order[k];
      int to = k;
      for (; to > begin && order[to - 1] > i; --to) order[to] = order[to - 1];
      order[to] = i;
    }
  }
};

}  // namespace grid_kernels

/// Makes a grid. Nothing is allocated unless there are more particles than before.
template <class Executor>
class ParticleGrid {
 public:
  template <class T>
  using Array = typename Executor::template Array<T>;

  /// For particles in a box of such extent [m]; edges of cubes are `support`, H [m].
  void shape(int particles, const double* extent, double support, double quantum) {
    view_.particles = particles;
    view_.edge = static_cast<int>(std::ceil(support / quantum)) + 1;
    view_.scale = static_cast<float>(quantum / support);
    // Most of the cubes that a box needs, but no more than twice as many as particles.
    int most = kLeastBits;
    while ((1 << most) < 2 * particles && most < kMostBits) ++most;
    int total = 0;
    for (int axis = 0; axis < 3; ++axis) {
      int bits = 2;
      while ((1 << bits) < extent[axis] / support + 2.0 && bits < 20) ++bits;
      view_.bits[axis] = bits;
      total += bits;
    }
    for (; total > most; --total) --*std::max_element(view_.bits, view_.bits + 3);
    for (; total < kLeastBits; ++total) ++view_.bits[0];
    const auto cubes = static_cast<std::size_t>(view_.cubes());
    const auto n = static_cast<std::size_t>(particles);
    grow(counts_, cubes);
    grow(begins_, cubes + 1);
    grow(sums_, cubes / kPrefixRun);
    grow(order_, n);
  }

  /// From positions by particle.
  void build(Executor& executor, const Fixed* x) {
    using namespace grid_kernels;
    const int cubes = view_.cubes();
    view_.begins = begins_.data();
    view_.order = order_.data();
    executor.launch(cubes, ClearCounts{counts_.data()});
    executor.launch(view_.particles, Count{view_, x, counts_.data()});
    sum_before(executor, counts_.data(), cubes, sums_.data(), begins_.data(), view_.particles);
    executor.launch(view_.particles, Scatter{view_, x, counts_.data(), order_.data()});
    executor.launch(cubes, SortCubes{begins_.data(), order_.data()});
  }

  const GridView& view() const { return view_; }

 private:
  static constexpr int kLeastBits = 10;  // kPrefixRun
  static constexpr int kMostBits = 24;
  template <class T>
  static void grow(Array<T>& array, std::size_t size) {
    if (array.size() < size) array.resize(size);
  }

  GridView view_;
  Array<int> counts_, begins_, sums_, order_;
};

}  // namespace pliant
