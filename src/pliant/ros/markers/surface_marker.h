#pragma once

#include <visualization_msgs/Marker.h>

#include <string>

#include "pliant/core/world.h"
#include "pliant/ros/running/snapshot.h"

namespace pliant {

/// Colours of a body's particles or surface vertices [0, 1], darkened by wetness.
class VertexColors {
 public:
  enum class Of { kParticles, kSurface };
  VertexColors(const Body& body, Of of);
  /// 3 x n, rgb, for n values of wetness in [0, 1]; none: all are dry.
  const Eigen::Matrix3Xf& update(const Eigen::VectorXd& wetness);

 private:
  Eigen::Matrix3Xf dry_;
  Eigen::Matrix3Xf colors_;
};

/// Whether a model's surface is closed, and so drawn as that of a solid: that of particles is, and
/// one that is embedded, as a rigid body's.
bool is_drawn_solid(const Model& model);

/// The surface of a body as one TRIANGLE_LIST with a stable id and, unless the surface is made anew
/// for each state, the same number of points each time. rviz does not light coloured triangles, so
/// their colours bring the shading along: the same for both sides of a sheet.
class SurfaceMarker {
 public:
  explicit SurfaceMarker(const Body& body);
  /// The marker before its first update; `space`: its namespace.
  visualization_msgs::Marker first(const std::string& frame, const std::string& space) const;
  /// Brings what first() gave up to date.
  void update(const BodySnapshot& snapshot, const std_msgs::Header& header,
              visualization_msgs::Marker& marker);

 private:
  VertexColors colors_;
  TriangleMesh mesh_;
  bool is_solid_;  // not a sheet
};

}  // namespace pliant
