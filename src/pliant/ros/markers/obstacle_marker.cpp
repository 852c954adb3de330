#include "pliant/ros/markers/obstacle_marker.h"

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/ros/conversions.h"
#include "pliant/ros/markers/shading.h"

namespace pliant {
namespace {

using visualization_msgs::Marker;

constexpr double kPlateSide = 2.0;         // [m]
constexpr double kPlateThickness = 0.002;  // [m]

void set_scale(const Eigen::Vector3d& size, int type, Marker& marker) {
  marker.type = type;
  marker.scale = to_vector3(size);
}

/// A box about `center`, in its own frame.
void set_box(const Box& box, const Eigen::Vector3d& center, const Eigen::Isometry3d& pose,
             const Eigen::Vector4f& color, Marker& marker) {
  set_scale(Eigen::Vector3d::Ones(), Marker::TRIANGLE_LIST, marker);
  const TriangleMesh mesh = box.surface();
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3d a = mesh.vertices.col(mesh.triangles(0, t));
    const Eigen::Vector3d b = mesh.vertices.col(mesh.triangles(1, t));
    const Eigen::Vector3d c = mesh.vertices.col(mesh.triangles(2, t));
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    const Eigen::Vector3f shaded = solid_brightness(pose.linear() * normal) * color.head<3>();
    for (const Eigen::Vector3d& corner : {a, b, c}) {
      marker.points.push_back(to_point(center + corner));
      marker.colors.push_back(to_color(shaded, color.w()));
    }
  }
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
  if (as<Plane>(*shape) != nullptr) {
    const Eigen::Vector3d below(0.0, 0.0, -0.5 * kPlateThickness);  // its upper face is the plane
    set_box(Box({kPlateSide, kPlateSide, kPlateThickness}), below, pose, obstacle.color, marker);
  } else if (const auto* sphere = as<Sphere>(*shape)) {
    set_scale(Eigen::Vector3d::Constant(2.0 * sphere->radius()), Marker::SPHERE, marker);
  } else if (const auto* box = as<Box>(*shape)) {
    set_box(*box, Eigen::Vector3d::Zero(), pose, obstacle.color, marker);
  } else if (const auto* cylinder = as<Cylinder>(*shape)) {
    const double diameter = 2.0 * cylinder->radius();
    set_scale({diameter, diameter, cylinder->length()}, Marker::CYLINDER, marker);
  } else {
    set_triangles(*shape, marker);
  }
  return marker;
}

}  // namespace pliant
