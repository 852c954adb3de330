#pragma once

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Vector3.h>
#include <std_msgs/ColorRGBA.h>

#include <Eigen/Geometry>

namespace pliant {

/// Between Eigen's types and ROS messages; units stay as they are.
Eigen::Vector3d to_vector(const geometry_msgs::Point& point);
Eigen::Vector3d to_vector(const geometry_msgs::Vector3& vector);
/// A quaternion of any length but zero, which gives NaN.
Eigen::Isometry3d to_isometry(const geometry_msgs::Transform& transform);

geometry_msgs::Point to_point(const Eigen::Vector3d& vector);
geometry_msgs::Vector3 to_vector3(const Eigen::Vector3d& vector);
geometry_msgs::Pose to_pose(const Eigen::Isometry3d& pose);
std_msgs::ColorRGBA to_color(const Eigen::Vector3f& rgb, float alpha = 1.0f);
std_msgs::ColorRGBA to_color(const Eigen::Vector4f& rgba);

}  // namespace pliant
