#include "pliant/ros/conversions.h"

namespace pliant {

Eigen::Vector3d to_vector(const geometry_msgs::Point& point) { return {point.x, point.y, point.z}; }

Eigen::Vector3d to_vector(const geometry_msgs::Vector3& vector) {
  return {vector.x, vector.y, vector.z};
}

Eigen::Isometry3d to_isometry(const geometry_msgs::Transform& transform) {
  const auto& q = transform.rotation;
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  isometry.translation() = to_vector(transform.translation);
  return isometry;
}

geometry_msgs::Point to_point(const Eigen::Vector3d& vector) {
  geometry_msgs::Point point;
  point.x = vector.x();
  point.y = vector.y();
  point.z = vector.z();
  return point;
}

geometry_msgs::Vector3 to_vector3(const Eigen::Vector3d& vector) {
  geometry_msgs::Vector3 message;
  message.x = vector.x();
  message.y = vector.y();
  message.z = vector.z();
  return message;
}

geometry_msgs::Pose to_pose(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  geometry_msgs::Pose message;
  message.position = to_point(pose.translation());
  message.orientation.x = q.x();
  message.orientation.y = q.y();
  message.orientation.z = q.z();
  message.orientation.w = q.w();
  return message;
}

std_msgs::ColorRGBA to_color(const Eigen::Vector3f& rgb, float alpha) {
  std_msgs::ColorRGBA color;
  color.r = rgb.x();
  color.g = rgb.y();
  color.b = rgb.z();
  color.a = alpha;
  return color;
}

std_msgs::ColorRGBA to_color(const Eigen::Vector4f& rgba) {
  return to_color(Eigen::Vector3f(rgba.head<3>()), rgba.w());
}

}  // namespace pliant
