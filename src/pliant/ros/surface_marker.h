#pragma once

#include <visualization_msgs/Marker.h>

#include <string>

#include "pliant/core/world.h"
#include "pliant/ros/snapshot.h"

namespace pliant {

/// Colours of the vertices of all bodies [0, 1], darkened where a field `wetness` (0 to 1) of
/// `fields` says so.
class VertexColors {
 public:
  explicit VertexColors(const World& world);
  /// 3 x n, rgb.
  const Eigen::Matrix3Xf& update(const std::map<std::string, Eigen::VectorXd>& fields);

 private:
  Eigen::Matrix3Xf dry_;
  Eigen::Matrix3Xf colors_;
};

/// The surfaces of all bodies as one TRIANGLE_LIST with a stable id and the same number of points
/// each time. rviz does not light coloured triangles, so their colours bring the shading along: the
/// same for both sides.
class SurfaceMarker {
 public:
  SurfaceMarker(const World& world, const std::string& frame);
  const visualization_msgs::Marker& update(const Snapshot& snapshot,
                                           const Eigen::Matrix3Xf& colors);

 private:
  TriangleMesh mesh_;  // of all bodies
  visualization_msgs::Marker marker_;
};

}  // namespace pliant
