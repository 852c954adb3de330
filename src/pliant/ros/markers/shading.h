#pragma once

#include <Eigen/Core>

namespace pliant {

/// rviz does not light what has colours of its own, and lights the rest from the camera, so that a
/// level table looks dark from the side. So colours bring the shading along, from one light above.

/// Towards the light, of unit length.
const Eigen::Vector3d& to_light();
/// Of a sheet, whose two sides are lit alike; `normal` has unit length.
float sheet_brightness(const Eigen::Vector3d& normal);
/// Of a solid's surface: dark where it turns away, softly, since there is but one light.
float solid_brightness(const Eigen::Vector3d& normal);

}  // namespace pliant
