#pragma once

#include <vector>

#include "pliant/elements/cloth/cell_shear_set.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/geometry/mesh/grid.h"

namespace pliant {

/// In-plane stiffness of a woven fabric, force per width and strain [N/m].
struct FabricStiffness {
  double warp = 0.0;   ///< along a grid's columns direction (x)
  double weft = 0.0;   ///< along a grid's rows direction (y)
  double shear = 0.0;  ///< shear force per width and shear angle
};

/// Springs along warp and weft of a grid: k = K w / l with the width w that a yarn stands for
/// (half at the cloth's edge). A direction with zero stiffness gets none.
std::vector<Spring> grid_stretch_springs(const GridOptions& grid, const FabricStiffness& stiffness);

/// Shear of each cell a x b by the difference of its diagonals: k = G (a² + b²) / (4 a b), so that
/// a cell sheared by the angle gamma stores 1/2 G gamma² a b. None for zero stiffness.
std::vector<ShearCell> grid_shear_cells(const GridOptions& grid, double shear);

/// Springs along one or both diagonals of each cell a x b: k = G (a² + b²) / (n a b) for n
/// diagonals, so that a cell sheared by the angle gamma stores 1/2 G gamma² a b. With n = 2 that is
/// half per diagonal. They resist stretch as well, by up to G along warp and weft alike.
std::vector<Spring> grid_shear_springs(const GridOptions& grid, double shear, int diagonals);

}  // namespace pliant
