#pragma once

#include <Eigen/Core>

#include "pliant/geometry/search/simplex_pair.h"

namespace pliant {

using FourPoints = Eigen::Matrix<double, 3, 4>;  ///< a column each [m]

/// As nearest_weights().
Eigen::Vector4d nearest_pair(SimplexPair kind, const FourPoints& x);

/// As PairApproach.
struct Approach {
  double time = 0.0;
  double start = 0.0;
  Eigen::Vector4d weights;
  Eigen::Vector3d between;
};

/// As that of PairPlaces.
bool find_approach(SimplexPair kind, const FourPoints& start, const FourPoints& end, double reach,
                   Approach& found);

}  // namespace pliant
