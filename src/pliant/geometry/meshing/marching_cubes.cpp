#include "pliant/geometry/meshing/marching_cubes.h"

namespace pliant {
namespace {

using Triangle = MarchingCubes::Triangle;

constexpr int kNone = -1;

int edge_between(int a, int b) {
  const int bit = a ^ b;
  const int axis = bit == 1 ? 0 : bit == 2 ? 1 : 2;
  const int low = a & b;
  // The bits of the other axes, packed.
  const int packed = axis == 0 ? low >> 1 : axis == 1 ? (low & 1) | (low >> 1 & 2) : low & 3;
  return 4 * axis + packed;
}

/// Corners of a face, counter-clockwise seen from outside.
std::array<int, 4> face_corners(int face) {
  const int axis = face / 2, side = face % 2;
  const int u = 1 << ((axis + 1) % 3), v = 1 << ((axis + 2) % 3), base = side << axis;
  if (side == 1) return {base, base | u, base | u | v, base | v};
  return {base, base | v, base | u | v, base | u};
}

bool share_a_face(int a, int b) {
  for (int face = 0; face < 6; ++face) {
    bool has_a = false, has_b = false;
    const std::array<int, 4> corners = face_corners(face);
    for (std::size_t k = 0; k < 4; ++k) {
      const int edge = edge_between(corners[k], corners[(k + 1) % 4]);
      has_a |= edge == a;
      has_b |= edge == b;
    }
    if (has_a && has_b) return true;
  }
  return false;
}

/// The crossing that follows each crossed edge along the surface's boundary in the cube.
std::array<int, 12> successors(int inside) {
  std::array<int, 12> next{};
  next.fill(kNone);
  for (int face = 0; face < 6; ++face) {
    const std::array<int, 4> c = face_corners(face);
    const auto is_in = [&](std::size_t k) { return (inside >> c[k % 4] & 1) != 0; };
    for (std::size_t k = 0; k < 4; ++k) {
      if (!is_in(k) || is_in(k + 1)) continue;
      // Back along the run of inside corners that ends here, to where it began.
      std::size_t begin = k + 4;
      while (is_in(begin - 1)) --begin;
      next[static_cast<std::size_t>(edge_between(c[k], c[(k + 1) % 4]))] =
          edge_between(c[(begin - 1) % 4], c[begin % 4]);
    }
  }
  return next;
}

/// Triangulates part [i, j] of a loop with the fewest diagonals on faces of the cube, where a
/// neighbour may have the same one. Returns how many.
int triangulate(const std::vector<int>& loop, std::size_t i, std::size_t j,
                std::vector<Triangle>& triangles) {
  if (j < i + 2) return 0;
  int best = 1000;
  std::vector<Triangle> chosen;
  const auto cost = [&](std::size_t a, std::size_t b) {
    const bool is_side = b == a + 1 || (a == 0 && b + 1 == loop.size());
    return !is_side && share_a_face(loop[a], loop[b]) ? 1 : 0;
  };
  for (std::size_t k = i + 1; k < j; ++k) {
    std::vector<Triangle> here = {{loop[i], loop[j], loop[k]}};
    int total = cost(i, k) + cost(k, j);
    total += triangulate(loop, i, k, here);
    total += triangulate(loop, k, j, here);
    if (total >= best) continue;
    best = total;
    chosen = std::move(here);
  }
  triangles.insert(triangles.end(), chosen.begin(), chosen.end());
  return best;
}

std::vector<Triangle> make_case(int inside) {
  std::array<int, 12> next = successors(inside);
  std::vector<Triangle> triangles;
  for (std::size_t start = 0; start < 12; ++start) {
    std::vector<int> loop;
    for (int edge = static_cast<int>(start); next[static_cast<std::size_t>(edge)] != kNone;) {
      loop.push_back(edge);
      const int following = next[static_cast<std::size_t>(edge)];
      next[static_cast<std::size_t>(edge)] = kNone;
      edge = following;
    }
    if (!loop.empty()) triangulate(loop, 0, loop.size() - 1, triangles);
  }
  return triangles;
}

}  // namespace

int MarchingCubes::edge_corner(int edge) {
  const int axis = edge / 4, k = edge % 4;
  if (axis == 0) return k << 1;
  if (axis == 1) return (k & 1) | (k & 2) << 1;
  return k;
}

const std::vector<Triangle>& MarchingCubes::triangles(int inside) {
  static const std::vector<std::vector<Triangle>> table = [] {
    std::vector<std::vector<Triangle>> cases;
    for (int c = 0; c < 256; ++c) cases.push_back(make_case(c));
    return cases;
  }();
  return table[static_cast<std::size_t>(inside)];
}

}  // namespace pliant
