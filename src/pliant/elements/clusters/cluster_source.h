#pragma once

#include "pliant/elements/clusters/cluster_set.h"

namespace pliant {

/// An element set that holds clusters which it makes anew as particles melt and freeze.
class ClusterSource {
 public:
  virtual ~ClusterSource() = default;
  /// Those of the present; null where nothing is solid.
  virtual const ClusterSet* set() const = 0;
  /// Whether particles have orientations of their own.
  virtual bool is_oriented() const = 0;
};

/// The clusters of a set of elements, `are_clusters` where it is one of clusters at all.
inline const ClusterSet* clusters_of(const ElementSet& elements, bool& are_clusters) {
  if (const ClusterSource* source = as<ClusterSource>(elements)) {
    are_clusters = true;
    return source->set();
  }
  const ClusterSet* clusters = as<ClusterSet>(elements);
  are_clusters = clusters != nullptr;
  return clusters;
}

}  // namespace pliant
