#pragma once

#include <string>
#include <vector>

#include "pliant/core/body/model.h"
#include "pliant/core/obstacle.h"
#include "pliant/effects/air/trapped_volume.h"

namespace pliant {

/// The numbers of the obstacles that cloth is sealed on: those, or all of the robot links, that
/// `names` lists with commas; "auto": the first plane, where there is none all that are no robot's.
/// Throws InputError for an unknown name, or where there is none.
std::vector<int> sealing_obstacles(const std::string& names,
                                   const std::vector<Obstacle>& obstacles);

/// The triangles of a cloth, wound so that it has its air below.
Eigen::Matrix3Xi triangles_above(const Model& model, const FootFinder& finder);

}  // namespace pliant
