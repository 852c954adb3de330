#pragma once

#include <visualization_msgs/Marker.h>

#include <string>

#include "pliant/core/world.h"
#include "pliant/ros/snapshot.h"

namespace pliant {

/// Colours of all bodies' particles or surface vertices [0, 1], darkened by wetness.
class VertexColors {
 public:
  enum class Of { kParticles, kSurface };
  VertexColors(const World& world, Of of);
  /// 3 x n, rgb, for n values of wetness in [0, 1]; none: all are dry.
  const Eigen::Matrix3Xf& update(const Eigen::VectorXd& wetness);

 private:
  Eigen::Matrix3Xf dry_;
  Eigen::Matrix3Xf colors_;
};

/// The surfaces of all bodies as one TRIANGLE_LIST with a stable id and, unless a body's surface is
/// made anew for each state, the same number of points each time. rviz does not light coloured
/// triangles, so their colours bring the shading along: the same for both sides of a sheet.
class SurfaceMarker {
 public:
  SurfaceMarker(const World& world, const std::string& frame);
  const visualization_msgs::Marker& update(const Snapshot& snapshot);

 private:
  void make_room();

  VertexColors colors_;
  TriangleMesh mesh_;                            // of all bodies
  Eigen::Array<bool, Eigen::Dynamic, 1> solid_;  // per vertex: not a sheet's
  visualization_msgs::Marker marker_;
};

}  // namespace pliant
