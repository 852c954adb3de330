#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "pliant/elements/clusters/cluster_source.h"
#include "pliant/elements/clusters/oriented_cluster_set.h"

namespace pliant {

/// What holds together.
struct SolidMaterial {
  double young = 1e4;             ///< Young's modulus [Pa]
  double alpha = 0.0;             ///< the paper's stiffness in [0, 1); 0: by `young`
  double cluster_radius = 0.0;    ///< [m]
  double cluster_fraction = 1.0;  ///< of the particles that are centres of a cluster
  bool rigid = false;             ///< one cluster of all particles
};

/// The solid half of particles between solid and liquid: shape matching over overlapping clusters
/// that particles leave as they melt and join as they freeze. A particle of blend `beta` takes part
/// in its clusters with the weight 1 − beta.
///
/// A cluster of the material holds E_c = 1/2 k_c Σ m |x − g|², and under a strain ε that is
/// 1/6 k_c tr(Σ m q qᵀ) |ε|². Each has k_c such that this is 1/2 E |ε|² times its share of the
/// volume, every particle's volume being shared by the clusters that hold it: the energy density of
/// Young's modulus E and Poisson's ratio 0, however many clusters there are and of what size.
class BlendedClusters final : public ElementSet, public ClusterSource {
 public:
  BlendedClusters(bool oriented, TurnBlend blend) : oriented_(oriented), blend_(blend) {}

  /// Adds particles as a part of its own; freeze() then makes the clusters of what is solid.
  void add_part(const Positions& x, const Eigen::VectorXd& masses, const Eigen::VectorXd& volumes,
                const SolidMaterial& material);
  /// Of the step that `alpha` refers to. Returns whether stiffnesses changed.
  bool set_time_step(double dt);
  /// Lets weights follow `beta`, at the positions `x`. Returns whether anything changed.
  bool follow(const Eigen::VectorXd& beta, const Positions& x);
  /// Whether weights are those of `beta`.
  bool follows(const Eigen::VectorXd& beta) const { return weights_of(beta) == weights_; }
  /// Rest shapes follow the particles; see ClusterSet.
  void creep(const Positions& x, double yield, double share);
  /// From now on what follow() and creep() take of the energy is kept for take_losses().
  void keep_losses() { keeps_losses_ = true; }
  /// What each particle lost since this was asked last [J]; empty: nothing.
  Eigen::VectorXd take_losses() { return std::exchange(losses_, {}); }
  /// Moves all particles to another place, where they are as strained as before.
  void place(const Eigen::Isometry3d& world_from_body);
  /// Orientations at the end of a step, where particles have some.
  void advance(const Positions& x, double dt);

  bool is_oriented() const override { return oriented_; }
  bool accept(ElementVisitor& visitor) const override {
    visitor.see(static_cast<const ClusterSource&>(*this));
    return true;
  }
  TurnBlend blend() const { return blend_; }
  int clusters() const { return inner_ ? inner_->size() : 0; }
  const ClusterSet* set() const override { return inner_.get(); }
  const OrientedClusterSet* oriented() const {
    return oriented_ ? static_cast<const OrientedClusterSet*>(inner_.get()) : nullptr;
  }
  const Eigen::VectorXd& weights() const { return weights_; }
  /// Whether a cluster holds both, or they lay side by side when their part was made and neither
  /// has melted since.
  bool are_bound(int i, int j) const;
  /// How many clusters hold each particle.
  Eigen::VectorXd counts() const;

  std::string_view name() const override { return oriented_ ? "oriented_cluster" : "cluster"; }
  int size() const override { return clusters(); }
  bool has_torque() const override { return oriented_; }
  double energy(const Positions& x) const override { return inner_ ? inner_->energy(x) : 0.0; }
  void add_forces(const Positions& x, Forces& f) const override;
  void add_to_system(SystemMatrix& a) const override;
  double work() const override { return inner_ ? inner_->work() : 0.0; }
  void add_stiffness(const Positions& x, Definiteness definiteness,
                     StiffnessMatrix& k) const override;
  void reset() override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;
  void reset_multipliers() override;
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override;

 private:
  struct Part {
    int first, count;
    double spacing;
    SolidMaterial material;
  };
  static Eigen::VectorXd weights_of(const Eigen::VectorXd& beta) {
    return (1.0 - beta.array()).max(0.0).min(1.0);
  }
  int part_of(int particle) const;
  Eigen::Quaterniond orientation(int particle) const;
  void freeze(const Positions& x, const std::vector<int>& frozen);
  void add_clusters(const Part& part, const Positions& x, const std::vector<int>& frozen);
  void keep_present();
  Eigen::VectorXd energies(const Positions& x) const;
  void note_loss(const Eigen::VectorXd& before, const Positions& x);
  void make_set(const Positions& x);
  void spread_stiffness();
  void take_rest();

  bool oriented_;
  TurnBlend blend_;
  double dt_ = 0.0;
  std::vector<Part> parts_;
  Eigen::VectorXd masses_, volumes_;
  Eigen::VectorXd weights_;                // of each particle; 0: in no cluster
  Positions made_;                         // where particles were when their part was made [m]
  Eigen::VectorXd lasting_;                // 1: solid ever since
  std::vector<std::vector<int>> holders_;  // of each particle, ascending: its clusters
  std::vector<Cluster> clusters_;
  std::vector<int> cluster_parts_;
  std::unique_ptr<ClusterSet> inner_;
  bool keeps_losses_ = false;
  Eigen::VectorXd losses_;  // of each particle [J]; empty: nothing since they were taken
};

}  // namespace pliant
