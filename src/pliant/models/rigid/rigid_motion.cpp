#include "pliant/models/rigid/rigid_motion.h"

namespace pliant {

Eigen::Matrix3d rotated_freely(const Eigen::Matrix3d& axes, const Eigen::Vector3d& moments,
                               const Eigen::Vector3d& angular_momentum, double dt) {
  Eigen::Matrix3d orientation = axes;
  const auto turn = [&](int k, double time) {
    // In the body's frame its momentum turns the other way; in space it stays.
    const double speed = orientation.col(k).dot(angular_momentum) / moments[k];
    orientation = orientation * Eigen::AngleAxisd(speed * time, Eigen::Vector3d::Unit(k));
  };
  turn(0, 0.5 * dt);
  turn(1, 0.5 * dt);
  turn(2, dt);
  turn(1, 0.5 * dt);
  turn(0, 0.5 * dt);
  return orientation;
}

}  // namespace pliant
