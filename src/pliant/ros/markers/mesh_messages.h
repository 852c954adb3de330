#pragma once

#include <pliant/MeshPoints.h>
#include <pliant/MeshTopology.h>

#include <string>

#include "pliant/ros/running/snapshot.h"

namespace pliant {

/// The surface of a body as triangles, said once, and points of 12 bytes.
class MeshMessages {
 public:
  /// `name`: of the body, as the scene calls it.
  MeshMessages(const Body& body, const std::string& name);
  const MeshTopology& topology() const { return topology_; }
  const MeshPoints& points() const { return points_; }
  void set_header(const std_msgs::Header& header) { topology_.header = header; }
  /// Brings both up to date. Returns whether the triangles are others than before.
  bool update(const BodySnapshot& snapshot, const std_msgs::Header& header);

 private:
  void set_triangles(const Eigen::Matrix3Xi& triangles, Eigen::Index vertices);

  MeshTopology topology_;
  MeshPoints points_;
};

}  // namespace pliant
