#include "pliant/ros/points_message.h"

#include <algorithm>
#include <cstring>

namespace pliant {
namespace {

constexpr int kFixedFields = 7;

/// As rviz and PCL read it: the bits of a float.
float pack_rgb(const Eigen::Vector3f& color) {
  const Eigen::Vector3f bytes = (255.0f * color).array().max(0.0f).min(255.0f).round();
  const std::uint32_t bits = (static_cast<std::uint32_t>(bytes.x()) << 16) |
                             (static_cast<std::uint32_t>(bytes.y()) << 8) |
                             static_cast<std::uint32_t>(bytes.z());
  float packed = 0.0f;
  std::memcpy(&packed, &bits, sizeof packed);
  return packed;
}

sensor_msgs::PointField float_field(const std::string& name, std::size_t index) {
  sensor_msgs::PointField field;
  field.name = name;
  field.offset = static_cast<std::uint32_t>(index * sizeof(float));
  field.datatype = sensor_msgs::PointField::FLOAT32;
  field.count = 1;
  return field;
}

}  // namespace

void PointsMessage::set_layout(const BodySnapshot& snapshot) {
  cloud_.fields.clear();
  for (const char* name : {"x", "y", "z", "rgb", "vx", "vy", "vz"}) {
    cloud_.fields.push_back(float_field(name, cloud_.fields.size()));
  }
  for (const auto& [name, values] : snapshot.fields) {
    cloud_.fields.push_back(float_field(name, cloud_.fields.size()));
  }
  cloud_.height = 1;
  cloud_.width = static_cast<std::uint32_t>(snapshot.x.cols());
  cloud_.point_step = static_cast<std::uint32_t>(cloud_.fields.size() * sizeof(float));
  cloud_.row_step = cloud_.width * cloud_.point_step;
  cloud_.is_bigendian = false;
  cloud_.is_dense = true;
  cloud_.data.resize(cloud_.row_step);
}

const sensor_msgs::PointCloud2& PointsMessage::update(const BodySnapshot& snapshot,
                                                      const std_msgs::Header& header,
                                                      const Eigen::Matrix3Xf& colors) {
  if (cloud_.fields.size() != kFixedFields + snapshot.fields.size() ||
      cloud_.width != snapshot.x.cols()) {
    set_layout(snapshot);
  }
  cloud_.header = header;
  auto* values = reinterpret_cast<float*>(cloud_.data.data());
  const std::size_t stride = cloud_.fields.size();
  for (Eigen::Index i = 0; i < snapshot.x.cols(); ++i) {
    float* point = values + static_cast<std::size_t>(i) * stride;
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = static_cast<float>(snapshot.x(axis, i));
      point[4 + axis] = static_cast<float>(snapshot.v(axis, i));
    }
    point[3] = pack_rgb(colors.col(i));
  }
  float* column = values + kFixedFields;
  for (const auto& [name, field] : snapshot.fields) {
    for (Eigen::Index i = 0; i < field.size(); ++i) {
      column[static_cast<std::size_t>(i) * stride] = static_cast<float>(field[i]);
    }
    ++column;
  }
  return cloud_;
}

}  // namespace pliant
