#pragma once

#include <Eigen/Core>

namespace pliant {

/// Sums over the neighbours of a body's particles, where they are now, that a device computes for
/// effects: in single precision, with W of poly6 and the body's volumes V and beta. Each returns
/// false, and leaves its result as it was, where it cannot: effects then sum themselves.
class PairSums {
 public:
  virtual ~PairSums() = default;
  /// Σⱼ min(βᵢ, βⱼ) Vᵢ Vⱼ ∇W [m²].
  virtual bool cohesion(Eigen::Matrix3Xd& sums) = 0;
  /// Σⱼ min(βᵢ, βⱼ) min(mᵢ, mⱼ) min(Vᵢ, Vⱼ) W (vⱼ − vᵢ) [kg m/s].
  virtual bool mixing(Eigen::Matrix3Xd& sums) = 0;
  /// The same of |vⱼ − vᵢ|² for given velocities `v` [J].
  virtual bool mixing_squares(const Eigen::Matrix3Xd& v, Eigen::VectorXd& sums) = 0;
  /// Σⱼ Vⱼ ∇W [1/m].
  virtual bool color_slope(Eigen::Matrix3Xd& sums) = 0;
  /// Σⱼ Vᵢ Vⱼ k (Tⱼ − Tᵢ) ∇²W of the viscosity kernel [W], k between the particles' parts: equal
  /// and opposite for each pair, and added up in double precision, so that heat is kept.
  virtual bool conduction(const Eigen::VectorXd& temperature, const Eigen::MatrixXd& conductivities,
                          Eigen::VectorXd& sums) = 0;
};

}  // namespace pliant
