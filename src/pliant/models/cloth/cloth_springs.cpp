#include "pliant/models/cloth/cloth_springs.h"

#include <cmath>

namespace pliant {
namespace {

struct Cell {
  double a, b;  // along columns and rows [m]
};

Cell cell_of(const GridOptions& grid) {
  return {grid.width / (grid.columns - 1), grid.height / (grid.rows - 1)};
}

double tributary(int index, int count, double spacing) {
  return index == 0 || index == count - 1 ? 0.5 * spacing : spacing;
}

}  // namespace

std::vector<Spring> grid_stretch_springs(const GridOptions& grid,
                                         const FabricStiffness& stiffness) {
  const auto [a, b] = cell_of(grid);
  std::vector<Spring> springs;
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      const int i = r * grid.columns + c;
      if (c + 1 < grid.columns && stiffness.warp > 0.0) {
        springs.push_back({i, i + 1, a, stiffness.warp * tributary(r, grid.rows, b) / a});
      }
      if (r + 1 < grid.rows && stiffness.weft > 0.0) {
        const double k = stiffness.weft * tributary(c, grid.columns, a) / b;
        springs.push_back({i, i + grid.columns, b, k});
      }
    }
  }
  return springs;
}

std::vector<ShearCell> grid_shear_cells(const GridOptions& grid, double shear) {
  std::vector<ShearCell> cells;
  if (shear <= 0.0) return cells;
  const auto [a, b] = cell_of(grid);
  const double k = shear * (a * a + b * b) / (4.0 * a * b);
  const int up = grid.columns;
  for (int r = 0; r + 1 < grid.rows; ++r) {
    for (int c = 0; c + 1 < grid.columns; ++c) {
      const int i = r * grid.columns + c;
      cells.push_back({{i, i + 1, i + up + 1, i + up}, k});
    }
  }
  return cells;
}

std::vector<Spring> grid_shear_springs(const GridOptions& grid, double shear, int diagonals) {
  std::vector<Spring> springs;
  if (shear <= 0.0) return springs;
  const auto [a, b] = cell_of(grid);
  const double l = std::sqrt(a * a + b * b);
  const double k = shear * l * l / (diagonals * a * b);
  for (int r = 0; r + 1 < grid.rows; ++r) {
    for (int c = 0; c + 1 < grid.columns; ++c) {
      const int i = r * grid.columns + c;
      springs.push_back({i, i + grid.columns + 1, l, k});
      if (diagonals == 2) springs.push_back({i + 1, i + grid.columns, l, k});
    }
  }
  return springs;
}

}  // namespace pliant
