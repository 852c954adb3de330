#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr const char* kAxes[3] = {"x", "y", "z"};
constexpr int kTetrahedraPerCell = 5;

// Corners of a cell: bit 0, 1, 2 says whether the corner lies at the far end in x, y, z.
constexpr int kEven[kTetrahedraPerCell][4] = {{0b000, 0b011, 0b101, 0b110},  // the middle
                                              {0b001, 0b011, 0b000, 0b101},
                                              {0b010, 0b000, 0b011, 0b110},
                                              {0b100, 0b101, 0b000, 0b110},
                                              {0b111, 0b101, 0b110, 0b011}};
constexpr int kMirrorX = 0b001;

void check(const BlockOptions& options) {
  std::int64_t count = kTetrahedraPerCell;
  for (int k = 0; k < 3; ++k) {
    if (!(std::isfinite(options.size[k]) && options.size[k] > 0.0)) {
      throw InputError(fmt::format("block: size along {} is {} m: allowed is (0, inf)", kAxes[k],
                                   options.size[k]));
    }
    if (options.cells[k] < 1) {
      throw InputError(fmt::format("block: cells along {} are {}: allowed is 1 or more", kAxes[k],
                                   options.cells[k]));
    }
    count = std::min(count * options.cells[k], std::int64_t{1} << 31);
  }
  if (count > kMaxTetrahedra) {
    throw InputError(
        fmt::format("block: {} x {} x {} cells have more than {} tetrahedra: take fewer cells, at "
                    "most {}",
                    options.cells[0], options.cells[1], options.cells[2], kMaxTetrahedra,
                    kMaxTetrahedra / kTetrahedraPerCell));
  }
}

Eigen::Matrix3Xd block_vertices(const BlockOptions& options) {
  const Eigen::Vector3i& n = options.cells;
  Eigen::Matrix3Xd vertices(3, (n[0] + 1) * (n[1] + 1) * (n[2] + 1));
  int v = 0;
  for (int k = 0; k <= n[2]; ++k) {
    for (int j = 0; j <= n[1]; ++j) {
      for (int i = 0; i <= n[0]; ++i, ++v) {
        const Eigen::Array3d share = Eigen::Array3d(i, j, k) / n.cast<double>().array();
        vertices.col(v) = (share - 0.5) * options.size.array();
      }
    }
  }
  return vertices;
}

}  // namespace

TetrahedralMesh make_block(const BlockOptions& options) {
  check(options);
  const Eigen::Vector3i& n = options.cells;
  TetrahedralMesh mesh;
  mesh.vertices = block_vertices(options);
  mesh.tetrahedra.resize(4, kTetrahedraPerCell * n.prod());
  const auto vertex = [&](int i, int j, int k) { return (k * (n[1] + 1) + j) * (n[0] + 1) + i; };
  int t = 0;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const int mirror = (i + j + k) % 2 == 0 ? 0 : kMirrorX;
        for (const auto& corners : kEven) {
          for (int c = 0; c < 4; ++c) {
            const int corner = corners[c] ^ mirror;
            mesh.tetrahedra(c, t) =
                vertex(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2 & 1));
          }
          ++t;
        }
      }
    }
  }
  fix_winding(mesh);  // a mirrored cell's tetrahedra are inverted
  return mesh;
}

}  // namespace pliant
