#include "pliant/ros/conversions.h"

namespace pliant {

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
