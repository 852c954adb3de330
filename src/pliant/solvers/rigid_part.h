#pragma once

#include <Eigen/Geometry>

#include "pliant/core/particles.h"

namespace pliant {

/// The rigid motion in displacements of particles, in the metric of their masses. Without it
/// displacements d hold no momentum, Σ m d = 0, and no moment about given places y, Σ m y × d = 0.
class RigidPart {
 public:
  /// Of all particles; a moment is taken about their places `y`.
  void prepare(const Positions& y, const Eigen::VectorXd& masses);
  void remove(Positions& displacements) const;

 private:
  Eigen::VectorXd masses_;
  Eigen::Matrix3Xd arms_;  // from the centre of mass [m]
  double mass_ = 0.0;
  Eigen::Matrix3d inverse_inertia_ = Eigen::Matrix3d::Zero();  // 0 about an axis without inertia
};

}  // namespace pliant
