#include "pliant/ros/obstacle_marker.h"

#include "pliant/geometry/primitive_shapes.h"
#include "pliant/ros/conversions.h"

namespace pliant {
namespace {

using visualization_msgs::Marker;

constexpr double kPlateSide = 2.0;         // [m]
constexpr double kPlateThickness = 0.002;  // [m]

void set_scale(const Eigen::Vector3d& size, int type, Marker& marker) {
  marker.type = type;
  marker.scale = to_vector3(size);
}

void set_triangles(const Shape& shape, Marker& marker) {
  set_scale(Eigen::Vector3d::Ones(), Marker::TRIANGLE_LIST, marker);
  const TriangleMesh mesh = shape.surface();
  marker.points.reserve(static_cast<std::size_t>(mesh.triangles.size()));
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      marker.points.push_back(to_point(mesh.vertices.col(mesh.triangles(k, t))));
    }
  }
}

}  // namespace

Marker obstacle_marker(const Obstacle& obstacle, const Eigen::Isometry3d& pose) {
  Marker marker;
  marker.ns = "obstacles";
  marker.action = Marker::ADD;
  marker.color = to_color(obstacle.color);
  marker.pose = to_pose(pose);
  const Shape* shape = obstacle.shape.get();
  if (dynamic_cast<const Plane*>(shape) != nullptr) {
    set_scale({kPlateSide, kPlateSide, kPlateThickness}, Marker::CUBE, marker);
    // Its upper face is the plane.
    const Eigen::Vector3d below(0.0, 0.0, -0.5 * kPlateThickness);
    marker.pose = to_pose(pose * Eigen::Translation3d(below));
  } else if (const auto* sphere = dynamic_cast<const Sphere*>(shape)) {
    set_scale(Eigen::Vector3d::Constant(2.0 * sphere->radius()), Marker::SPHERE, marker);
  } else if (const auto* box = dynamic_cast<const Box*>(shape)) {
    set_scale(box->size(), Marker::CUBE, marker);
  } else if (const auto* cylinder = dynamic_cast<const Cylinder*>(shape)) {
    const double diameter = 2.0 * cylinder->radius();
    set_scale({diameter, diameter, cylinder->length()}, Marker::CYLINDER, marker);
  } else {
    set_triangles(*shape, marker);
  }
  return marker;
}

}  // namespace pliant
