#pragma once

#include <Eigen/Geometry>
#include <string>

namespace pliant {

struct LoadedScene;

/// What a camera should show of a scene as it starts [m]: all bodies, the links of robots, and
/// obstacles that are no larger than `kLargestObstacle` times the rest (a plane has no bounds, and
/// a floor of 10 m is no reason to stand far off). Where there is nothing else, all bounded
/// obstacles; a cube of 1 m for an empty scene.
Eigen::AlignedBox3d scene_bounds(const LoadedScene& scene);

constexpr double kLargestObstacle = 2.0;

/// `configuration` (YAML of an rviz configuration whose view is an orbit) with its camera moved
/// back or forth, its direction kept, until it shows a ball around `bounds`. Throws InputError
/// where there is no such view.
std::string framed_configuration(const std::string& configuration,
                                 const Eigen::AlignedBox3d& bounds);

}  // namespace pliant
