#pragma once

#include <vector>

#include "pliant/elements/clusters/cluster_set.h"

namespace pliant {

/// In what order the clusters of shape matching move their particles, and which of them count.
struct ClusterOrder {
  int groups = 1;               ///< that follow each other; 0: every cluster comes by itself
  bool by_deformation = false;  ///< strongly deformed clusters count more
};

/// Iterations of shape matching by goals alone, as the thesis on particles from rigid to liquid has
/// them (eqs. 2.31 to 2.35). A cluster k wants its particles at the goals g_k = R_k (x⁰ − x⁰_cm) +
/// x_cm. Groups of clusters follow each other, each from the newest positions; within a group a
/// particle goes to the mean of what its clusters want,
///   x = Σ_k w_k g_k / Σ_k w_k,
/// with w_k = 1 or, by deformation, w_k = d_k = Σ_j |g_k,j − x_j| over all particles j of the
/// cluster. One group of all clusters is Jacobi, each cluster by itself Gauss-Seidel, and what is
/// between them the hybrid. Clusters know no modulus here: all of them want to keep their shape,
/// and how near they come is a matter of iterations.
class ClusterSweep {
 public:
  explicit ClusterSweep(ClusterOrder order) : order_(order) {}

  /// Shapes, weights or which particles are pinned changed. `inverse_mass` of a pinned one is 0.
  void prepare(const ClusterSet& set, const Eigen::VectorXd& inverse_mass);
  /// One iteration: every cluster once.
  void iterate(const ClusterSet& set, Positions& x);
  /// Σ_k d_k over Σ_k Σ_j |x⁰_j − x⁰_cm|: 0 where every cluster has its shape.
  double strain(const ClusterSet& set, const Positions& x) const;
  /// How many groups there are.
  int groups() const { return static_cast<int>(groups_.size()); }
  /// How much a particle takes part in its clusters, 0 to 1; 0 where nothing moves it.
  const Eigen::VectorXd& parts() const { return parts_; }

 private:
  struct Goal {
    int cluster;
    Eigen::Vector3d rest;  // from the cluster's centre of mass [m]
  };
  struct Group {
    std::vector<int> clusters;
    std::vector<int> particles;  // that it moves
    std::vector<int> begins;     // of each particle's goals
    std::vector<Goal> goals;
  };
  void add_group(const ClusterSet& set, std::vector<int> clusters,
                 const Eigen::VectorXd& inverse_mass);
  void fit(const ClusterSet& set, const Group& group, const Positions& x);
  void move(const Group& group, Positions& x) const;

  ClusterOrder order_;
  std::vector<Group> groups_;
  Eigen::VectorXd parts_;
  double extent_ = 0.0;                      // Σ_k Σ_j |x⁰_j − x⁰_cm| [m]
  std::vector<ClusterSet::Motion> motions_;  // of each cluster, when its group had its turn
  std::vector<double> weights_;              // w_k likewise
};

}  // namespace pliant
