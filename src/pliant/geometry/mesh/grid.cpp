#include "pliant/geometry/mesh/grid.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "pliant/math/error.h"

namespace pliant {
namespace {

void check_length(const char* field, double value) {
  if (std::isfinite(value) && value > 0.0) return;
  throw InputError(fmt::format("grid: {} is {} m: allowed is (0, inf)", field, value));
}

void check_count(const char* field, int value) {
  if (value >= 2) return;
  throw InputError(fmt::format("grid: {} is {}: allowed is 2 or more", field, value));
}

void check(const GridOptions& o) {
  check_length("width", o.width);
  check_length("height", o.height);
  check_count("columns", o.columns);
  check_count("rows", o.rows);
  const std::int64_t triangles = 2 * (std::int64_t{o.columns} - 1) * (std::int64_t{o.rows} - 1);
  if (triangles <= kMaxTriangles) return;
  throw InputError(
      fmt::format("grid: {} columns x {} rows give {} triangles: at most {} are allowed", o.columns,
                  o.rows, triangles, kMaxTriangles));
}

}  // namespace

TriangleMesh make_grid(const GridOptions& o) {
  check(o);
  TriangleMesh mesh;
  mesh.vertices.resize(3, o.columns * o.rows);
  for (int row = 0; row < o.rows; ++row) {
    for (int column = 0; column < o.columns; ++column) {
      const double x = o.width * (double(column) / (o.columns - 1) - 0.5);
      const double y = o.height * (double(row) / (o.rows - 1) - 0.5);
      mesh.vertices.col(row * o.columns + column) << x, y, 0.0;
    }
  }
  mesh.triangles.resize(3, 2 * (o.columns - 1) * (o.rows - 1));
  int next = 0;
  for (int row = 0; row + 1 < o.rows; ++row) {
    for (int column = 0; column + 1 < o.columns; ++column) {
      const int a = row * o.columns + column;
      const int b = a + 1;
      const int c = b + o.columns;
      const int d = a + o.columns;
      // Diagonals that all lean the same way would make the cloth stiffer along one of them.
      const bool even = (row + column) % 2 == 0;
      mesh.triangles.col(next++) << a, b, (even ? c : d);
      mesh.triangles.col(next++) << (even ? a : b), c, d;
    }
  }
  return mesh;
}

}  // namespace pliant
