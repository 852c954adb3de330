#pragma once

#include <Eigen/Geometry>

namespace pliant {

/// Weighted means of rotations, one column (x, y, z, w) each; weights >= 0, not all 0.

/// Sum of the quaternions, each with the sign nearer to the first, normalised (QLERP).
Eigen::Quaterniond linear_rotation_mean(const Eigen::Ref<const Eigen::Matrix4Xd>& rotations,
                                        const Eigen::Ref<const Eigen::VectorXd>& weights);
/// The rotation from which the mean of the rotation vectors to all of them vanishes: by the
/// exponential map about the linear mean, repeated.
Eigen::Quaterniond exponential_rotation_mean(const Eigen::Ref<const Eigen::Matrix4Xd>& rotations,
                                             const Eigen::Ref<const Eigen::VectorXd>& weights,
                                             int repeats = 3);

}  // namespace pliant
