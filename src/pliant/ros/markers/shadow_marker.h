#pragma once

#include <visualization_msgs/Marker.h>

#include <vector>

#include "pliant/core/world.h"
#include "pliant/ros/running/snapshot.h"

namespace pliant {

/// Shadows of bodies and obstacles on level planes and boxes, from the light of shading.h: without
/// them nobody sees how far something is above a table. They are the casters' triangles, projected,
/// in one colour a table; nothing casts a shadow on what is not level.
class ShadowMarker {
 public:
  explicit ShadowMarker(const World& world);
  const visualization_msgs::Marker& update(const Snapshot& snapshot);

 private:
  /// The upper face of a level plane or box.
  struct Table {
    std::size_t obstacle;
    Eigen::Vector2d half;  // of its sides [m]
    double top;            // above the shape's origin [m]
    Eigen::Vector3f color;
  };
  struct Caster {
    std::size_t obstacle;
    TriangleMesh mesh;  // in its frame
  };

  void add_mesh(const TriangleMesh& mesh, bool is_solid, const Snapshot& snapshot);
  void add_triangle(const Eigen::Matrix3d& corners, const Snapshot& snapshot);
  void sort_tables(const Snapshot& snapshot);

  std::vector<Table> tables_;  // the highest first
  std::vector<Caster> casters_;
  std::vector<TriangleMesh> bodies_;
  std::vector<bool> body_is_solid_;
  visualization_msgs::Marker marker_;
};

}  // namespace pliant
