#pragma once

#include <string>
#include <vector>

#include "pliant/core/system/element_set.h"
#include "pliant/elements/clusters/cluster_shapes.h"
#include "pliant/elements/clusters/packed_clusters.h"
#include "pliant/elements/element_visitor.h"

namespace pliant {

/// Shape matching over overlapping clusters (Müller et al. 2005, "Meshless deformations based on
/// shape matching") as a projective energy,
///   E = 1/2 Σ_c k_c Σ_i m_i |x_i - x_cm - R_c (x⁰_i - x⁰_cm)|²,
/// with R_c the rotation nearest to the moment A_c = Σ m_i (x_i - x_cm) (x⁰_i - x⁰_cm)ᵀ. A
/// converged solve means the same at any time step and number of iterations.
///
/// Any rest shape will do: of a flat, straight, coincident or single-particle cluster the rotation
/// that A leaves free has no effect on energy and forces. Where the present state alone leaves it
/// free (a body crushed to a line) the rotation of the last add_forces() or relax() decides;
/// elsewhere results depend on no history.
class ClusterSet : public ElementSet {
 public:
  /// [R x_cm], the rigid motion of a cluster that fits best.
  using Motion = PackedClusters::Motion;

  /// `rest` 3 x n [m], `masses` n [kg]. Throws InputError as ClusterShapes does.
  ClusterSet(const Positions& rest, const Eigen::VectorXd& masses,
             const std::vector<Cluster>& clusters);

  std::string_view name() const override { return name_; }
  int size() const override { return shapes_.size(); }
  bool is_solid() const override { return true; }
  bool has_torque() const override { return !spins_.empty(); }
  bool accept(ElementVisitor& visitor) const override {
    visitor.see(*this);
    return true;
  }
  double energy(const Positions& x) const override;
  /// What of it each particle holds in its clusters [J].
  Eigen::VectorXd particle_energies(const Positions& x) const;
  void add_forces(const Positions& x, Forces& f) const override;
  void add_to_system(SystemMatrix& a) const override;
  double work() const override;
  void add_stiffness(const Positions& x, Definiteness definiteness,
                     StiffnessMatrix& k) const override;
  void reset() override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;
  void reset_multipliers() override { multipliers_.setZero(); }
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override;

  /// Melting and cooling, k >= 0 [1/s²]: the energy is proportional to it. Solvers that keep the
  /// system matrix have to be prepared again. Throws InputError for a cluster out of range or a
  /// stiffness that is negative or not finite.
  void set_stiffness(int cluster, double stiffness);
  /// How much each particle takes part in its clusters, 0 to 1, at the positions `x`. What grows is
  /// bound as it lies there, so that the energy never rises. Solvers have to be prepared again.
  void set_weights(const Eigen::VectorXd& weights, const Positions& x);
  /// Rest shapes follow the particles at `x`: where a cluster's strain, the root of
  /// Σ m |x − g|² / Σ m |q|², is above `yield`, by `share` (0 to 1) of what is above it. The energy
  /// never rises, and solvers need not be prepared again.
  void creep(const Positions& x, double yield, double share);

  const ClusterShapes& shapes() const { return shapes_; }
  /// The motion of one cluster, and those of all, which stand until forces or others are asked for.
  Motion fit(int cluster, const Positions& x) const;
  const std::vector<Motion>& fits(const Positions& x) const;
  /// What the orientations of its particles add to the moment of each cluster, Σ w O D [kg m²];
  /// empty where particles have none.
  const std::vector<Eigen::Matrix3d>& turned_spins() const;
  /// Another one whenever shapes, weights or stiffnesses changed; no other set has had it.
  long version() const { return version_; }

 protected:
  static Eigen::Matrix3d rotation_of(const Motion& motion) { return motion.topLeftCorner<3, 3>(); }
  struct Incidence {
    int cluster, member;
  };

  ClusterSet(std::string name, const Positions& rest, const Eigen::VectorXd& masses,
             const std::vector<Cluster>& clusters);

  /// Fits every cluster to `x` and keeps the result: motion().
  void fit_all(const Positions& x) const { fit_all(x, fits_); }
  const Motion& motion(int cluster) const { return fits_[static_cast<std::size_t>(cluster)]; }
  /// The clusters that hold a particle: incidences()[incidence_begin(i)] to the next particle's.
  int incidence_begin(int particle) const {
    return incidence_begins_[static_cast<std::size_t>(particle)];
  }
  const Incidence& incidence(int number) const {
    return incidences_[static_cast<std::size_t>(number)];
  }
  int particles() const { return static_cast<int>(incidence_begins_.size()) - 1; }
  /// To be called wherever orientations_ change.
  void orientations_changed() { turned_spins_.clear(); }

  // Oriented particles only, otherwise empty: turn from rest, and ∫ρ r rᵀ at rest [kg m²].
  std::vector<Eigen::Matrix3d> orientations_;
  std::vector<Eigen::Matrix3d> spins_;

 private:
  Eigen::Matrix3d moment(int cluster, const Positions& x, const Eigen::Vector3d& center) const;
  Eigen::Matrix3d turned_spin(int cluster) const;
  void sum_turned_spins() const;
  Eigen::Matrix3d rotation(int cluster, const Eigen::Matrix3d& moment) const;
  void fit_all(const Positions& x, std::vector<Motion>& fits) const;
  void fit_range(int begin, int end, std::vector<Motion>& fits) const;
  static long new_version();
  void changed();
  void shape_changed(int cluster);
  /// Calls `add`(particle, m |x - g|² and what its turn adds) for each of a cluster's members, by
  /// energy_fits_.
  template <class Add>
  void for_each_square(int cluster, const Positions& x, const Add& add) const;
  void find_stiffness(int cluster, const Positions& x, Definiteness definiteness,
                      SharedStiffness& shared) const;
  void relax(int cluster, const Eigen::VectorXd& inverse_mass, double dt2, Positions& x);

  std::string name_;
  ClusterShapes shapes_;
  long version_ = new_version();
  std::vector<int> incidence_begins_;
  std::vector<Incidence> incidences_;
  mutable PackedClusters packed_;
  mutable std::vector<Motion> fits_;                   // of the last add_forces() or relax()
  mutable std::vector<Motion> energy_fits_;            // of energies, which change nothing else
  mutable std::vector<Eigen::Matrix3d> turned_spins_;  // Σ w O D of clusters; empty: not known
  Positions multipliers_;                              // 3 x members [N]
};

}  // namespace pliant
