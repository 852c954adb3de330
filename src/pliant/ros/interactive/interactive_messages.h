#pragma once

#include <visualization_msgs/InteractiveMarker.h>
#include <visualization_msgs/InteractiveMarkerControl.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// A line of a menu; those with children only open them.
struct MenuLine {
  std::uint32_t id;          ///< > 0
  std::uint32_t parent = 0;  ///< 0: at the top
  std::string title;
};

/// The surface of a body, unseen, which the mouse can take anywhere and move in the plane of the
/// picture.
visualization_msgs::InteractiveMarker surface_to_drag(const std::string& name,
                                                      const std::string& frame,
                                                      const TriangleMesh& surface,
                                                      const std::vector<MenuLine>& menu);

/// The line of a spring, from what is dragged to where it is dragged to; nothing to take hold of.
visualization_msgs::InteractiveMarker spring_line(const std::string& name, const std::string& frame,
                                                  const Eigen::Vector3d& from,
                                                  const Eigen::Vector3d& to, double width);

/// Arrows, and rings where it can turn, around a robot's hand.
visualization_msgs::InteractiveMarker hand_to_drag(const std::string& name,
                                                   const std::string& frame,
                                                   const Eigen::Isometry3d& pose, double size,
                                                   bool can_turn,
                                                   const std::vector<MenuLine>& menu);

}  // namespace pliant
