#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/elements/clusters/cluster_shapes.h"

namespace pliant {

/// The members of clusters laid out for loops over all of them, in vectors of four numbers: by
/// cluster for the fits, by particle for the forces. A copy, made anew when shapes change.
class PackedClusters {
 public:
  /// [R x_cm], the rigid motion of a cluster that fits best; the last row is 0.
  using Motion = Eigen::Matrix4d;

  void build(const ClusterShapes& shapes, int particles);
  bool is_built() const { return !begins_.empty(); }
  /// What was built no longer holds.
  void clear() { begins_.clear(); }

  /// The particles' positions that the following work with.
  void set_positions(const Positions& x);
  /// x_cm and A = Σ m (x − x_cm) (x⁰ − x⁰_cm)ᵀ of clusters [begin, end) in one pass: since Σ m x⁰
  /// is nothing in a cluster's frame, any point near it serves in place of x_cm.
  void gather(int begin, int end, Eigen::Vector3d* centers, Eigen::Matrix3d* moments) const;
  /// f += Σ over its clusters of k m (x_cm + R q − x), for particles [begin, end) [N].
  void add_forces(int begin, int end, const std::vector<Motion>& motions, Forces& f) const;

 private:
  // Vectors and indices apart: together they would be filled up to twice the size of a vector, and
  // loops over them wait for the memory.
  std::vector<int> begins_;             // of each cluster's members
  std::vector<double> masses_;          // of clusters, inverse; 0 for one that holds nothing
  std::vector<Eigen::Vector4d> loads_;  // (m q, m) of members, cluster by cluster
  std::vector<int> particles_;          // of members
  std::vector<int> shares_;             // where each particle's pulls begin
  std::vector<Eigen::Vector4d> pulls_;  // k (m q, m), particle by particle, in the clusters' order
  std::vector<int> clusters_;           // of pulls
  std::vector<Eigen::Vector4d> x_;
};

}  // namespace pliant
