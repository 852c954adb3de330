#pragma once

#include "pliant/elements/clusters/cluster_set.h"

namespace pliant {

/// ∫ρ r rᵀ of a solid ellipsoid of mass m [kg] with the semi-axes a [m] along the columns of
/// `axes`: m/5 Q diag(a²) Qᵀ [kg m²].
Eigen::Matrix3d ellipsoid_moment(double mass, const Eigen::Vector3d& semi_axes,
                                 const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity());

/// How a particle's turn is blended from those of its clusters and its own motion: as the rotation
/// nearest to the sum of moments, which minimises the energy, or as a mean of quaternions, with the
/// same weights.
enum class TurnBlend { kMoments, kLinear, kExponential };

/// Shape matching with oriented particles (Müller and Chentanez 2011, "Solid simulation with
/// oriented particles"): every particle is a small body of moment D_i that turns by O_i, and each
/// cluster minimises over its rotation R_c
///   E = 1/2 Σ_c k_c Σ_i [ m_i |x_i - x_cm - R_c (x⁰_i - x⁰_cm)|² + |(O_i - R_c) √D_i|² ],
/// so that R_c is the rotation nearest to Σ_i (O_i D_i) + A_c, which has full rank for any number
/// of particles in any arrangement: rods resist torsion, sheets bending.
///
/// Positions are the solvers' business; orientations follow them in advance_orientations(), once
/// a step. In between they are held: forces are -∂E/∂x, and with the couples that turn the
/// particles they hold no momentum.
class OrientedClusterSet final : public ClusterSet {
 public:
  /// `moments`: D_i of each particle [kg m²]. Throws InputError as ClusterShapes does, and for a
  /// moment that is not finite, symmetric and positive definite.
  OrientedClusterSet(const Positions& rest, const Eigen::VectorXd& masses,
                     const std::vector<Eigen::Matrix3d>& moments,
                     const std::vector<Cluster>& clusters);

  /// One implicit step of the rotations at the end `x` of a time step dt > 0 [s]: from where the
  /// angular velocities take them, O_i goes to the minimum of
  ///   |(O_i - O_pred) √D_i|² / dt² + Σ_c k_c |(O_i - R_c) √D_i|².
  /// With kLinear and kExponential instead to the mean of all these (math/rotation_mean.h).
  void advance_orientations(const Positions& x, double dt);
  void set_blend(TurnBlend blend) { blend_ = blend; }
  /// Back to the orientations of the rest shape, without angular velocity.
  void reset() override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;

  using ClusterSet::particles;
  /// O_i, the turn from the rest shape.
  Eigen::Quaterniond orientation(int particle) const;
  const Eigen::Vector3d& angular_velocity(int particle) const {
    return velocities_[static_cast<std::size_t>(particle)];
  }
  /// A new state, `angular_velocity` in world axes [rad/s].
  void set_orientation(int particle, const Eigen::Quaterniond& orientation,
                       const Eigen::Vector3d& angular_velocity);

 private:
  Eigen::Matrix3d moments_turn(int particle, const Eigen::Matrix3d& predicted, double dt) const;
  Eigen::Matrix3d mean_turn(int particle, const Eigen::Matrix3d& predicted, double dt,
                            Eigen::Matrix4Xd& turns, Eigen::VectorXd& weights) const;
  /// h² times what pulls a particle's turn to that of the cluster of one incidence.
  double pull(const Incidence& incidence, double dt) const;

  TurnBlend blend_ = TurnBlend::kMoments;
  std::vector<Eigen::Vector3d> velocities_;  // in world axes [rad/s]
};

}  // namespace pliant
