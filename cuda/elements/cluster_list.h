#pragma once

#include <vector>

#include "cuda/core/vector.h"

namespace pliant {

class ClusterSet;
class ElementSet;

/// The clusters of a system, by the places of their members.
struct ClusterList {
  std::vector<int> begins = {0};  ///< of each cluster's members, and the end
  std::vector<int> members;       ///< places; each cluster's first one is near its middle
  std::vector<Float4> loads;      ///< of members: q from the cluster's middle [m], m [kg]
  std::vector<float> stiffness;   ///< of clusters [1/s²]
  /// Where places rest in one frame for all clusters [quanta], and their masses [kg]; empty where
  /// shapes do not fit together: after creep, or where something froze.
  std::vector<Fixed> rest;
  std::vector<float> quanta;  ///< of clusters' frames [m]
  std::vector<int> numbers;   ///< of clusters: which each is in its set
  bool is_oriented = false;   ///< any of them have particles that turn: list_spins() tells how far

  int size() const { return static_cast<int>(stiffness.size()); }
};

/// Whether a set's elements are clusters that have a device form, and these: null where nothing is
/// solid.
bool is_cluster_set(const ElementSet& set, const ClusterSet*& clusters);

/// Of `places` places; `place` of each particle.
ClusterList list_clusters(const ClusterSet& set, const std::vector<int>& place, int places);

/// Appends to `spins` what the orientations of its particles add to the moments of the clusters of
/// `set` [kg m²], row by row, in the order of the list, where they are the ones that follow those
/// in `spins` already. Zeros where its particles have no orientations.
void list_spins(const ClusterSet& set, const ClusterList& list, std::vector<float>& spins);

/// Appends those of another scene, whose `places` places begin at `first_place`.
void append_clusters(const ClusterList& from, int first_place, int places, ClusterList& to);

}  // namespace pliant
