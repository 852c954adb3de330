#pragma once

#include <visualization_msgs/Marker.h>

#include "pliant/core/obstacle.h"

namespace pliant {

/// An obstacle as a marker of namespace "obstacles", without header and id. `pose`: world from
/// shape. A plane is shown as a plate of 2 m. Boxes and planes are triangles with their shading
/// (shading.h).
visualization_msgs::Marker obstacle_marker(const Obstacle& obstacle, const Eigen::Isometry3d& pose);

}  // namespace pliant
