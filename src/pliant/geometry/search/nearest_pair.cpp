#include "pliant/geometry/search/nearest_pair.h"

namespace pliant {
namespace {

PairPlaces places(const FourPoints& x) {
  PairPlaces places;
  for (int k = 0; k < 4; ++k) places.at[k] = {x(0, k), x(1, k), x(2, k)};
  return places;
}

}  // namespace

Eigen::Vector4d nearest_pair(SimplexPair kind, const FourPoints& x) {
  return Eigen::Vector4d(nearest_weights(kind, places(x)).of);
}

bool find_approach(SimplexPair kind, const FourPoints& start, const FourPoints& end, double reach,
                   Approach& found) {
  PairApproach approach{found.time, found.start, {{0.0, 0.0, 0.0, 0.0}}, {0.0, 0.0, 0.0}};
  const bool comes_near = find_approach(kind, places(start), places(end), reach, approach);
  found = {approach.time, approach.start, Eigen::Vector4d(approach.weights.of),
           Eigen::Vector3d(approach.between.x, approach.between.y, approach.between.z)};
  return comes_near;
}

}  // namespace pliant
