#pragma once

#include <Eigen/Core>

namespace pliant {

/// Two simplices of four points together: the first point and the triangle of the others, or the
/// segment of the first two and that of the last two.
enum class SimplexPair { kPointTriangle, kSegments };

using FourPoints = Eigen::Matrix<double, 3, 4>;  ///< a column each [m]

/// Weights w of the four points whose sum, x w, leads from the nearest point of the second simplex
/// to that of the first. Of each simplex their sizes sum to 1. For degenerate ones too; where
/// several points are nearest any one of them.
Eigen::Vector4d nearest_pair(SimplexPair kind, const FourPoints& x);

/// Where two simplices come near.
struct Approach {
  double time = 0.0;        ///< in [0, 1]
  double start = 0.0;       ///< distance at time 0 [m]; also where they do not come near
  Eigen::Vector4d weights;  ///< of nearest_pair() at that time
  Eigen::Vector3d way;      ///< x w at that time [m]
};

/// Whether simplices whose points move straight from `start` to `end` come nearer than `reach` > 0
/// [m], and about where first: conservative advancement, which steps no farther than the points'
/// speeds allow (Mirtich 1996). What comes not nearer than 0.9 `reach` may go unnoticed; what is
/// not finite never meets.
bool find_approach(SimplexPair kind, const FourPoints& start, const FourPoints& end, double reach,
                   Approach& found);

}  // namespace pliant
