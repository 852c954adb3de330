#include "pliant/ros/markers/points_message.h"

#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

using sensor_msgs::PointCloud2Iterator;
using sensor_msgs::PointField;

constexpr int kFixedFields = 7;

std::uint8_t to_byte(float share) {
  return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(share, 0.0f, 1.0f)));
}

}  // namespace

void PointsMessage::set_fields(const BodySnapshot& snapshot) {
  sensor_msgs::PointCloud2Modifier modifier(cloud_);
  constexpr int kFloat = PointField::FLOAT32;
  modifier.setPointCloud2Fields(kFixedFields, "x", 1, kFloat, "y", 1, kFloat, "z", 1, kFloat, "rgb",
                                1, kFloat, "vx", 1, kFloat, "vy", 1, kFloat, "vz", 1, kFloat);
  // The modifier takes no list whose length is known only now.
  for (const auto& [name, values] : snapshot.fields) {
    PointField field;
    field.name = name;
    field.offset = cloud_.point_step;
    field.datatype = PointField::FLOAT32;
    field.count = 1;
    cloud_.fields.push_back(field);
    cloud_.point_step += sizeof(float);
  }
  cloud_.height = 1;
  cloud_.is_bigendian = false;
  cloud_.is_dense = true;
}

const sensor_msgs::PointCloud2& PointsMessage::update(const BodySnapshot& snapshot,
                                                      const std_msgs::Header& header,
                                                      const Eigen::Matrix3Xf& colors) {
  const auto count = static_cast<std::size_t>(snapshot.x.cols());
  const bool is_new = cloud_.fields.size() != kFixedFields + snapshot.fields.size();
  if (is_new) set_fields(snapshot);
  if (is_new || cloud_.width != count) sensor_msgs::PointCloud2Modifier(cloud_).resize(count);
  cloud_.header = header;
  if (count == 0) return cloud_;
  PointCloud2Iterator<float> x(cloud_, "x"), v(cloud_, "vx");
  PointCloud2Iterator<std::uint8_t> blue(cloud_, "b");  // then green and red
  for (Eigen::Index i = 0; i < snapshot.x.cols(); ++i, ++x, ++v, ++blue) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto place = static_cast<std::size_t>(axis);
      x[place] = static_cast<float>(snapshot.x(axis, i));
      v[place] = static_cast<float>(snapshot.v(axis, i));
      blue[place] = to_byte(colors(2 - axis, i));
    }
  }
  for (const auto& [name, values] : snapshot.fields) {
    PointCloud2Iterator<float> value(cloud_, name);
    for (Eigen::Index i = 0; i < values.size(); ++i, ++value)
      *value = static_cast<float>(values[i]);
  }
  return cloud_;
}

}  // namespace pliant
