#pragma once

#include <sensor_msgs/PointCloud2.h>

#include "pliant/ros/running/snapshot.h"

namespace pliant {

/// The vertices of a body: x y z [m], rgb, vx vy vz [m/s], and every point field, each a
/// float32. The index of a point is that of its vertex.
class PointsMessage {
 public:
  /// `colors`: rgb of each vertex in [0, 1].
  const sensor_msgs::PointCloud2& update(const BodySnapshot& snapshot,
                                         const std_msgs::Header& header,
                                         const Eigen::Matrix3Xf& colors);

 private:
  void set_fields(const BodySnapshot& snapshot);

  sensor_msgs::PointCloud2 cloud_;
};

}  // namespace pliant
