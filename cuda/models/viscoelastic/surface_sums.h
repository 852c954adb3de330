#pragma once

#include <cstdint>

#include "cuda/core/vector.h"
#include "pliant/models/viscoelastic/surface_device.h"

/// The colour field of particles, as ParticleSurface and NearbyParticles sum it. Lengths are in
/// edges of the cells, which are the support of the kernels.
namespace pliant {

/// Cells begin with -1: there are blocks about those that hold particles.
PLIANT_HOST_DEVICE inline std::uint64_t surface_key(int x, int y, int z) {
  constexpr int kBits = 21, kFirst = 2;
  return static_cast<std::uint64_t>(x + kFirst) | static_cast<std::uint64_t>(y + kFirst) << kBits |
         static_cast<std::uint64_t>(z + kFirst) << 2 * kBits;
}

/// Particles by rank, cell by cell.
struct SurfaceParticles {
  const std::uint64_t* keys = nullptr;  ///< of cells, ascending
  const int* firsts = nullptr;          ///< rank of each cell's first one, and the end
  int cells = 0;
  const Fixed* x = nullptr;        ///< from cell (0, 0, 0), and V W(0)
  const float* weights = nullptr;  ///< what they count for
  int bits = 0;                    ///< quanta along a cell are 2^bits

  /// The first of the cells whose key is no less.
  PLIANT_HOST_DEVICE int find(std::uint64_t key) const {
    int low = 0, high = cells;
    while (low < high) {
      const int middle = (low + high) / 2;
      if (keys[middle] < key) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }
  PLIANT_HOST_DEVICE int cell_of_rank(int rank) const {
    int low = 0, high = cells;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      if (firsts[middle] <= rank) {
        low = middle;
      } else {
        high = middle;
      }
    }
    return low;
  }
  PLIANT_HOST_DEVICE Float3 from_corner(int rank, const Fixed& cell) const {
    const Fixed corner = {cell.x << bits, cell.y << bits, cell.z << bits, 0.0f};
    return (1.0f / static_cast<float>(1 << bits)) * (x[rank] - corner);
  }
};

/// Ranks of the particles in the nine rows of three cells about each of some cells.
struct FindRows {
  static constexpr int kRows = 9;
  SurfaceParticles particles;
  const Fixed* cells;
  int count;
  int *begins, *ends;  ///< row r of cell c at count r + c

  PLIANT_HOST_DEVICE void operator()(int c) const {
    const Fixed cell = cells[c];
    for (int r = 0; r < kRows; ++r) {
      const int y = cell.y + r % 3 - 1, z = cell.z + r / 3 - 1;
      begins[count * r + c] = particles.firsts[particles.find(surface_key(cell.x - 1, y, z))];
      ends[count * r + c] = particles.firsts[particles.find(surface_key(cell.x + 2, y, z))];
    }
  }
};

struct SurfaceRows {
  const Fixed* cells = nullptr;
  const int *begins = nullptr, *ends = nullptr;
  int count = 0;

  /// Calls sum(rank, from the point, squared) for the particles about cell c that are nearer than 1
  /// to a `point` of it.
  template <class Sum>
  PLIANT_HOST_DEVICE void for_each_near(const SurfaceParticles& particles, int c, Float3 point,
                                        Sum& sum) const {
    const Fixed cell = cells[c];
    for (int r = 0; r < FindRows::kRows; ++r) {
      const int end = ends[count * r + c];
      for (int j = begins[count * r + c]; j < end; ++j) {
        const Float3 apart = particles.from_corner(j, cell) - point;
        const float squared = dot(apart, apart);
        if (squared < 1.0f) sum(j, apart, squared);
      }
    }
  }
};

/// What particles count for, and the cells at the boundary.
struct WeighSurface {
  SurfaceParticles particles;  // `weights` are not yet known
  SurfaceRows rows;
  float* weights;
  char* at_boundary;  ///< of cells

  struct Sum {
    const Fixed* x;
    float sum;
    Float3 aside;
    PLIANT_HOST_DEVICE void operator()(int j, Float3 apart, float squared) {
      const float left = 1.0f - squared;
      const float kernel = x[j].w * (left * left * left);
      sum += kernel;
      aside += kernel * apart;
    }
  };
  PLIANT_HOST_DEVICE void operator()(int rank) const {
    const int cell = particles.cell_of_rank(rank);
    Sum sum{particles.x, 0.0f, {0.0f, 0.0f, 0.0f}};
    rows.for_each_near(particles, cell, particles.from_corner(rank, rows.cells[cell]), sum);
    const float more = SurfaceLimits::kThin / sum.sum;
    weights[rank] = particles.x[rank].w * (more > 1.0f ? more : 1.0f);
    // All threads write the same number.
    if (sum.sum < SurfaceLimits::kFull || norm(sum.aside) > SurfaceLimits::kAside * sum.sum) {
      at_boundary[cell] = 1;
    }
  }
};

/// The field at the nodes of blocks, block by block.
struct FillNodes {
  SurfaceParticles particles;
  SurfaceRows rows;  ///< about the blocks
  int detail;
  float* values;

  struct Sum {
    const float* weights;
    float sum;
    PLIANT_HOST_DEVICE void operator()(int j, Float3, float squared) {
      const float left = 1.0f - squared;
      sum += weights[j] * (left * left * left);
    }
  };
  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int block = i / (detail * detail * detail), n = i - block * detail * detail * detail;
    const float step = 1.0f / static_cast<float>(detail);
    const Float3 point = {step * static_cast<float>(n % detail),
                          step * static_cast<float>(n / detail % detail),
                          step * static_cast<float>(n / (detail * detail))};
    Sum sum{particles.weights, 0.0f};
    rows.for_each_near(particles, block, point, sum);
    values[i] = sum.sum;
  }
};

}  // namespace pliant
