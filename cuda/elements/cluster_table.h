#pragma once

#include <vector>

#include "cuda/elements/cluster_forces.h"
#include "cuda/elements/cluster_list.h"

namespace pliant {

/// A list of clusters laid out as ClustersView describes it.
struct ClusterTable {
  int clusters = 0, small = 0, chunks = 0;
  std::vector<int> order;  ///< of the list: which each cluster is there
  std::vector<int> begins, members, origins, owners, first_chunks;
  std::vector<Float4> loads;
  std::vector<Fixed> rest;
  std::vector<ClusterMotion> motions;
  std::vector<float> stiffness;
  std::vector<int> pull_begins, pull_clusters;
  std::vector<Float4> pull_loads;
};

/// `chunk`: members that one thread sums.
ClusterTable lay_out(const ClusterList& list, int places, int chunk);

}  // namespace pliant
