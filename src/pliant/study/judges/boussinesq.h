#pragma once

#include <Eigen/Core>

namespace pliant {

/// How far a force [N] down on the origin moves the point `x` of an elastic half-space z < 0, of
/// Young's modulus [Pa] and Poisson's ratio (Boussinesq 1885) [m].
Eigen::Vector3d boussinesq(double force, double young, double poisson, const Eigen::Vector3d& x);

}  // namespace pliant
