#pragma once

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Vector3.h>
#include <std_msgs/ColorRGBA.h>
#include <tf2_eigen/tf2_eigen.h>

#include <Eigen/Geometry>

namespace pliant {

/// tf2_eigen's conversions between Eigen's types and ROS messages, as values; units stay as they
/// are.
inline Eigen::Vector3d to_vector(const geometry_msgs::Point& point) {
  Eigen::Vector3d vector;
  tf2::fromMsg(point, vector);
  return vector;
}
inline Eigen::Vector3d to_vector(const geometry_msgs::Vector3& message) {
  Eigen::Vector3d vector;
  tf2::fromMsg(message, vector);
  return vector;
}
inline Eigen::Isometry3d to_isometry(const geometry_msgs::Transform& transform) {
  return tf2::transformToEigen(transform);
}
inline geometry_msgs::Point to_point(const Eigen::Vector3d& vector) { return tf2::toMsg(vector); }
inline geometry_msgs::Vector3 to_vector3(const Eigen::Vector3d& vector) {
  geometry_msgs::Vector3 message;
  return tf2::toMsg(vector, message);
}
inline geometry_msgs::Pose to_pose(const Eigen::Isometry3d& pose) { return tf2::toMsg(pose); }
inline geometry_msgs::Transform to_transform(const Eigen::Isometry3d& pose) {
  return tf2::eigenToTransform(pose).transform;
}

std_msgs::ColorRGBA to_color(const Eigen::Vector3f& rgb, float alpha = 1.0f);
std_msgs::ColorRGBA to_color(const Eigen::Vector4f& rgba);

}  // namespace pliant
