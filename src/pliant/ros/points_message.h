#pragma once

#include <sensor_msgs/PointCloud2.h>

#include "pliant/ros/snapshot.h"

namespace pliant {

/// The vertices of all bodies: x y z [m], rgb, vx vy vz [m/s], and every point field, each a
/// float32. The index of a point is that of its vertex.
class PointsMessage {
 public:
  /// `colors`: rgb of each vertex in [0, 1].
  const sensor_msgs::PointCloud2& update(const Snapshot& snapshot, const Eigen::Matrix3Xf& colors);

 private:
  void set_layout(const Snapshot& snapshot);

  sensor_msgs::PointCloud2 cloud_;
};

}  // namespace pliant
