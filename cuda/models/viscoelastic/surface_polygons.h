#pragma once

#include "cuda/core/vector.h"

/// Marching cubes over blocks of nodes, as BlockPolygons makes them: the same vertices and
/// triangles in the same order.
namespace pliant {

/// Triangles of the 256 cases of a cube (MarchingCubes).
struct CubeTable {
  const int* begins = nullptr;  ///< first triangle of each case, and the end
  const int* edges = nullptr;   ///< three a triangle

  PLIANT_HOST_DEVICE static int edge_corner(int edge) {
    const int axis = edge / 4, k = edge % 4;
    if (axis == 0) return k << 1;
    if (axis == 1) return (k & 1) | (k & 2) << 1;
    return k;
  }
};

struct SurfaceGrid {
  int detail = 2;
  const Fixed* cells = nullptr;   ///< of blocks
  const int* next = nullptr;      ///< blocks at +(0 or 1) along x, y, z, 8 a block; -1: none
  const float* values = nullptr;  ///< at nodes, block by block
  float level = 0.5f;
  // Of nodes, by ClassifyNodes.
  unsigned char* cases = nullptr;
  int* vertex_of = nullptr;  ///< three edges each, within the block; -1: none

  PLIANT_HOST_DEVICE int nodes() const { return detail * detail * detail; }
  /// The node at (x, y, z), each from 0 to detail; -1: there is none.
  PLIANT_HOST_DEVICE int node(int block, int x, int y, int z) const {
    const int beyond_x = x == detail ? 1 : 0, beyond_y = y == detail ? 1 : 0;
    const int beyond_z = z == detail ? 1 : 0;
    const int other = next[8 * block + (beyond_x | beyond_y << 1 | beyond_z << 2)];
    if (other < 0) return -1;
    return other * nodes() + (x - beyond_x * detail) +
           detail * ((y - beyond_y * detail) + detail * (z - beyond_z * detail));
  }
  PLIANT_HOST_DEVICE int corner(int block, int x, int y, int z, int corner) const {
    return node(block, x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2 & 1));
  }
  /// Calls visit(node, x, y, z) for the nodes of a block.
  template <class Visit>
  PLIANT_HOST_DEVICE void for_each_node(int block, Visit& visit) const {
    int number = block * nodes();
    for (int z = 0; z < detail; ++z) {
      for (int y = 0; y < detail; ++y) {
        for (int x = 0; x < detail; ++x) visit(number++, x, y, z);
      }
    }
  }
};

/// Cases of the cube above each node, its edges' vertices, and how many a block has.
struct ClassifyNodes {
  SurfaceGrid grid;
  CubeTable table;
  int *vertices, *triangles;  ///< of blocks

  struct Visit {
    const SurfaceGrid& grid;
    const CubeTable& table;
    int block, vertices, triangles;
    PLIANT_HOST_DEVICE void operator()(int node, int x, int y, int z) {
      int inside = 0;
      bool is_complete = true;
      for (int k = 0; k < 8; ++k) {
        const int at = grid.corner(block, x, y, z, k);
        is_complete = is_complete && at >= 0;
        if (at >= 0 && grid.values[at] > grid.level) inside |= 1 << k;
      }
      const int shape = is_complete ? inside : 0;
      grid.cases[node] = static_cast<unsigned char>(shape);
      triangles += table.begins[shape + 1] - table.begins[shape];
      for (int axis = 0; axis < 3; ++axis) {
        const bool crosses = grid.corner(block, x, y, z, 1 << axis) >= 0 &&
                             (inside & 1) != (inside >> (1 << axis) & 1);
        grid.vertex_of[3 * node + axis] = crosses ? vertices++ : -1;
      }
    }
  };
  PLIANT_HOST_DEVICE void operator()(int block) const {
    Visit visit{grid, table, block, 0, 0};
    grid.for_each_node(block, visit);
    vertices[block] = visit.vertices;
    triangles[block] = visit.triangles;
  }
};

/// Where edges cross the level, in world.
struct PlaceVertices {
  SurfaceGrid grid;
  const int* firsts;  ///< vertices before each block
  double origin[3];   ///< of node (0, 0, 0) of cell (0, 0, 0) [m]
  double step;        ///< between nodes [m]
  double* vertices;   ///< three numbers each [m]

  struct Visit {
    const PlaceVertices& all;
    int block;
    PLIANT_HOST_DEVICE void operator()(int node, int x, int y, int z) {
      // Of an edge: not onto a node, where triangles would have no area.
      constexpr double kOffNodes = 1e-3;
      const SurfaceGrid& grid = all.grid;
      const int cell[3] = {grid.cells[block].x, grid.cells[block].y, grid.cells[block].z};
      const int at[3] = {x, y, z};
      for (int axis = 0; axis < 3; ++axis) {
        const int number = grid.vertex_of[3 * node + axis];
        if (number < 0) continue;
        const float a = grid.values[node];
        const float b = grid.values[grid.corner(block, x, y, z, 1 << axis)];
        double along = static_cast<double>((grid.level - a) / (b - a));
        along = along < kOffNodes ? kOffNodes : (along > 1.0 - kOffNodes ? 1.0 - kOffNodes : along);
        double* to = all.vertices + 3 * (all.firsts[block] + number);
        for (int k = 0; k < 3; ++k) {
          to[k] = all.origin[k] + grid.detail * all.step * cell[k] +
                  all.step * (at[k] + (k == axis ? along : 0.0));
        }
      }
    }
  };
  PLIANT_HOST_DEVICE void operator()(int block) const {
    Visit visit{*this, block};
    if (firsts[block + 1] > firsts[block]) grid.for_each_node(block, visit);
  }
};

struct PlaceTriangles {
  SurfaceGrid grid;
  CubeTable table;
  const int *firsts, *first_vertices;  ///< before each block
  int* triangles;                      ///< three vertices each

  struct Visit {
    const PlaceTriangles& all;
    int block, next;
    PLIANT_HOST_DEVICE void operator()(int node, int x, int y, int z) {
      const SurfaceGrid& grid = all.grid;
      const int shape = grid.cases[node];
      const int end = 3 * all.table.begins[shape + 1];
      for (int k = 3 * all.table.begins[shape]; k < end; ++k) {
        const int edge = all.table.edges[k];
        const int low = grid.corner(block, x, y, z, CubeTable::edge_corner(edge));
        all.triangles[next++] =
            all.first_vertices[low / grid.nodes()] + grid.vertex_of[3 * low + edge / 4];
      }
    }
  };
  PLIANT_HOST_DEVICE void operator()(int block) const {
    Visit visit{*this, block, 3 * firsts[block]};
    if (firsts[block + 1] > firsts[block]) grid.for_each_node(block, visit);
  }
};

/// How many there are of all blocks.
struct CountAll {
  const int *vertices, *triangles;  ///< before each block, and the end
  int blocks;
  int* counts;
  PLIANT_HOST_DEVICE void operator()(int) const {
    counts[0] = vertices[blocks];
    counts[1] = triangles[blocks];
  }
};

}  // namespace pliant
