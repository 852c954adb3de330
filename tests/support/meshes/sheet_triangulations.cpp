#include "support/meshes/sheet_triangulations.h"

#include "support/random.h"

namespace pliant {

const char* name_of(Triangulation mesh) {
  switch (mesh) {
    case Triangulation::kAlternating:
      return "alternating";
    case Triangulation::kOneSided:
      return "one_sided";
    case Triangulation::kRandomDiagonals:
      return "random_diagonals";
    case Triangulation::kIrregular:
      break;
  }
  return "irregular";
}

TriangleMesh triangulated(const GridOptions& grid, Triangulation kind, int regular_columns) {
  TriangleMesh mesh = make_grid(grid);
  if (kind == Triangulation::kAlternating) return mesh;
  Random random(21);
  const double most = 0.25;
  for (int i = 0; i < mesh.vertices.cols(); ++i) {
    const int row = i / grid.columns, column = i % grid.columns;
    const double x = random(-most, most), y = random(-most, most);
    if (kind != Triangulation::kIrregular) continue;
    if (column >= regular_columns && column + 1 < grid.columns) {
      mesh.vertices(0, i) += x * grid.width / (grid.columns - 1);
    }
    if (row > 0 && row + 1 < grid.rows) {
      mesh.vertices(1, i) += y * grid.height / (grid.rows - 1);
    }
  }
  int next = 0;
  for (int row = 0; row + 1 < grid.rows; ++row) {
    for (int column = 0; column + 1 < grid.columns; ++column) {
      const int a = row * grid.columns + column, b = a + 1, c = b + grid.columns, d = c - 1;
      const bool rises = kind == Triangulation::kOneSided || random(0.0, 1.0) < 0.5;
      mesh.triangles.col(next++) << a, b, (rises ? c : d);
      mesh.triangles.col(next++) << (rises ? a : b), c, d;
    }
  }
  return mesh;
}

}  // namespace pliant
