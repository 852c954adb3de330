#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pliant/core/world.h"

namespace pliant {

/// A place where a body is touched by an obstacle, a robot link's shape, or another body.
struct TouchedPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< of the body [m]
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< of length 1, from what touches it
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< on the body, normal force and friction [N]
  int body = 0;
  int vertex = 0;       ///< particle of the body that carries most of the point
  int obstacle = -1;    ///< that touches it; -1: a body does
  int other_body = -1;  ///< likewise; the same as `body` where it touches itself
};

/// Replaces `touched` by what carries force at the end of the last step (of a step that was taken
/// in substeps, at the end of the last of them), body by body. A place between two bodies is listed
/// once. Of a resident run on a GPU (World::advance()) nothing is known.
void list_contacts(const World& world, std::vector<TouchedPoint>& touched);

/// What users know it by that touches: a body, an obstacle, a robot's link rather than one of its
/// shapes.
const std::string& name_of_other(const TouchedPoint& touched, const World& world);

}  // namespace pliant
