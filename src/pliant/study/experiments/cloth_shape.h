#pragma once

#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/geometry/mesh/grid.h"

namespace pliant {

/// Folds of a lifted cloth, as ridges of its height around the place where it is lifted.
struct Folds {
  std::vector<double> heights;     ///< each 360/size degrees about the place, from +x on [m]
  std::vector<double> directions;  ///< of ridges [deg], ascending
};

/// Height of a grid's surface over the plane z = 0 at `at`; the highest where it is folded over, 0
/// where there is none [m].
double height_at(const GridOptions& grid, const Positions& x, const Eigen::Vector2d& at);

/// On a circle of `radius` about `center`. A ridge stands out by at least a fifth of what heights
/// differ by; a circle that is level to 2 % of its mean height has none.
Folds find_folds(const GridOptions& grid, const Positions& x, const Eigen::Vector2d& center,
                 double radius);

/// Of the circle that is as large as the part of the cloth, at rest, that is higher than `above`.
double wetted_radius(const Eigen::VectorXd& areas, const Positions& x, double above);

}  // namespace pliant
