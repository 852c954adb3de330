#pragma once

#include <Eigen/Core>

namespace pliant {

// Shapes as functions of a point that are negative inside and near the surface about the signed
// distance [m], and how they join: enough to model a smooth solid in a few lines.

/// Two balls and what lies between them: a limb that tapers.
double round_cone(const Eigen::Vector3d& p, const Eigen::Vector3d& from, double from_radius,
                  const Eigen::Vector3d& to, double to_radius);

/// A box of these half extents about `center`, its edges rounded by `radius` within it.
double rounded_box(const Eigen::Vector3d& p, const Eigen::Vector3d& center,
                   const Eigen::Vector3d& half, double radius);

/// The union, with a fillet where both are nearer than `width` > 0 to each other's surface.
double blended(double a, double b, double width);

}  // namespace pliant
