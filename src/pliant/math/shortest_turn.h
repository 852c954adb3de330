#pragma once

#include <Eigen/Geometry>

namespace pliant {

/// The rotation by the least angle that takes the direction of `from` to that of `to`; of opposite
/// directions, half a turn about some axis at right angles to them. As Eigen's FromTwoVectors(),
/// which compiles a singular value decomposition for that case in every file that names it.
Eigen::Quaterniond shortest_turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace pliant
