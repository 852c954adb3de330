#pragma once

#include <Eigen/Geometry>

namespace pliant {

/// The free rotation of a rigid body for `dt` [s]: its orientation after it. `moments` [kg m²] are
/// the principal moments of inertia, the columns of `axes` the principal axes, `angular_momentum`
/// [kg m²/s] is about the centre of mass and stays. The splitting of Dullweber, Leimkuhler and
/// McLachlan (1997, "Symplectic splitting methods for rigid body molecular dynamics"): turns about
/// one axis after the other and back, of second order, symplectic and reversible, so that the
/// energy of a spinning body stays within a bound for any number of steps.
Eigen::Matrix3d rotated_freely(const Eigen::Matrix3d& axes, const Eigen::Vector3d& moments,
                               const Eigen::Vector3d& angular_momentum, double dt);

}  // namespace pliant
