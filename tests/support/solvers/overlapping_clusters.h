#pragma once

#include <vector>

#include "pliant/elements/clusters/cluster_shapes.h"
#include "support/random.h"

namespace pliant {

/// Clusters of `size` particles that follow one another, each `step` after the last, with
/// stiffnesses from `softest` to `stiffest` [1/s²]; and one of the three that begin it, are in its
/// middle and end it.
inline std::vector<Cluster> overlapping_clusters(int particles, int size, int step, double softest,
                                                 double stiffest, Random& random) {
  std::vector<Cluster> clusters;
  for (int first = 0; first + size <= particles; first += step) {
    Cluster cluster{{}, random(softest, stiffest), {}};
    for (int i = first; i < first + size; ++i) cluster.particles.push_back(i);
    clusters.push_back(cluster);
  }
  clusters.push_back({{1, particles / 2, particles - 1}, stiffest, {}});
  return clusters;
}

}  // namespace pliant
