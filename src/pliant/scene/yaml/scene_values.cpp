#include <fmt/format.h>

#include <algorithm>

#include "pliant/math/error.h"
#include "pliant/scene/reading/scene_readers.h"

namespace pliant {

std::vector<ParameterSpec> pose_parameters(const FiniteCheck& limits) {
  return {vector_parameter("position", "m", "[0, 0, 0]", limits.max_distance, "of its origin"),
          vector_parameter("rotation_rpy", "rad", "[0, 0, 0]", 100.0,
                           "roll, pitch, yaw about the fixed axes x, y, z, in this order")};
}

Eigen::Isometry3d read_pose(const YamlMap& map) {
  const Eigen::Vector3d& rpy = map.vector("rotation_rpy");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = map.vector("position");
  pose.linear() = (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  return pose;
}

ParameterSpec friction_parameter() {
  return number_parameter("friction", "", "0", 0.0, 100.0,
                          "Coulomb coefficient instead of the friction effect's");
}

ParameterSpec temperature_parameter() {
  return number_parameter("temperature", "K", "293.15", 0.0, 1e5,
                          "of the surface, for the effect heat; left out, it passes no heat");
}

ParameterSpec scale_parameter() {
  return positive_parameter("scale", "", "1", 1e6, "factor on the mesh's lengths");
}

Eigen::Vector4f read_color(const YamlNode& node, const std::string& field, int most) {
  const std::string expected = most == 3 ? "3 numbers from 0 to 1: [red, green, blue]"
                                         : "3 or 4 numbers from 0 to 1: [red, green, blue, alpha]";
  const std::vector<double> numbers = read_numbers(node, field, 3, most, 0.0, 1.0, expected);
  Eigen::Vector4f color(0.0f, 0.0f, 0.0f, 1.0f);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    color[static_cast<Eigen::Index>(i)] = static_cast<float>(numbers[i]);
  }
  return color;
}

std::string read_path(const YamlNode& node, const std::string& field,
                      const PackageResolver& resolver) {
  const std::string where = node.place().text() + ": " + field;
  return resolve_path(read_text(node, field), *node.file, resolver, where);
}

std::string read_unique_name(const YamlMap& map, std::vector<std::string>& taken) {
  const YamlNode& node = map.require("name", "a name of letters, digits, '_' or '-'");
  std::string name = read_name(node, map.field("name"));
  if (std::find(taken.begin(), taken.end(), name) != taken.end()) {
    throw InputError(fmt::format("{}: {} '{}' is taken by an earlier one", node.place().text(),
                                 map.field("name"), name));
  }
  taken.push_back(name);
  return name;
}

std::vector<ParameterSpec> joined(std::vector<ParameterSpec> first,
                                  const std::vector<ParameterSpec>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace pliant
