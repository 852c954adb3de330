#pragma once

#include <Eigen/Core>

#include "pliant/core/body/particles.h"

namespace pliant {

/// Points that a body's particles carry, such as a smooth surface around its tetrahedra: each is a
/// weighted mean of four particles.
class EmbeddedPoints {
 public:
  EmbeddedPoints() = default;
  /// 4 x n each; the weights of a point sum to 1 and may be negative.
  EmbeddedPoints(Eigen::Matrix4Xi particles, Eigen::Matrix4Xd weights);

  int size() const { return static_cast<int>(particles_.cols()); }
  const Eigen::Matrix4Xi& particles() const { return particles_; }
  const Eigen::Matrix4Xd& weights() const { return weights_; }
  void set_weights(int point, const Eigen::Vector4d& weights) { weights_.col(point) = weights; }

  Eigen::Vector3d position(const Positions& x, int point) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int k = 0; k < 4; ++k) sum += weights_(k, point) * x.col(particles_(k, point));
    return sum;
  }
  /// Of all points, 3 x n [m].
  void positions(const Positions& x, Eigen::Ref<Eigen::Matrix3Xd> points) const;
  /// What a field of the particles is at the points.
  Eigen::VectorXd interpolate(const Eigen::VectorXd& field) const;

 private:
  Eigen::Matrix4Xi particles_;
  Eigen::Matrix4Xd weights_;
};

}  // namespace pliant
