#include "pliant/scene/robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"
#include "pliant/scene/robot_builder.h"
#include "pliant/scene/robot_data.h"
#include "pliant/scene/text_file.h"
#include "pliant/scene/urdf_reader.h"

namespace pliant {
namespace {

Eigen::Isometry3d to_isometry(const KDL::Frame& frame) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) {
    pose.translation()[i] = frame.p[i];
    for (int j = 0; j < 3; ++j) pose.linear()(i, j) = frame.M(i, j);
  }
  return pose;
}

std::optional<int> index_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<int>(found - names.begin());
}

}  // namespace

Robot::Robot(std::unique_ptr<Data> data) : data_(std::move(data)) {}
Robot::Robot(Robot&&) noexcept = default;
Robot& Robot::operator=(Robot&&) noexcept = default;
Robot::~Robot() = default;

Robot Robot::from_file(const std::string& path, const PackageResolver& resolver) {
  return Robot(build_robot(read_text_file(path, kMaxUrdfBytes), path, resolver, path));
}

Robot Robot::from_text(const std::string& urdf, const PackageResolver& resolver,
                       const std::string& where) {
  return Robot(build_robot(urdf, "", resolver, where));
}

Robot Robot::kinematics_from_text(const std::string& urdf, const std::string& where) {
  return Robot(build_kinematics(urdf, where));
}

const std::string& Robot::name() const { return data_->name; }
const std::vector<std::string>& Robot::joint_names() const { return data_->joint_names; }
const std::vector<std::string>& Robot::link_names() const { return data_->link_names; }
const std::vector<double>& Robot::initial_positions() const { return data_->initial; }

std::optional<int> Robot::joint_index(const std::string& joint) const {
  return index_of(data_->joint_names, joint);
}

std::optional<int> Robot::link_index(const std::string& link) const {
  return index_of(data_->link_names, link);
}

Robot::Limits Robot::limits(int joint) const {
  return data_->limits.at(static_cast<std::size_t>(joint));
}

void Robot::set_base_pose(const Eigen::Isometry3d& world_from_base) {
  data_->world_from_base = world_from_base;
}

void Robot::set_initial_position(const std::string& joint, double value) {
  const std::optional<int> index = joint_index(joint);
  if (!index) throw InputError(unknown_name_message("joint", joint, joint_names()));
  const Limits range = limits(*index);
  if (!(std::isfinite(value) && value >= range.lower && value <= range.upper)) {
    throw InputError(fmt::format("joint '{}' is {}, but must be from {:g} to {:g} [m or rad]",
                                 joint, value, range.lower, range.upper));
  }
  data_->initial[static_cast<std::size_t>(*index)] = value;
}

void Robot::set_positions(const std::vector<std::string>& names, const std::vector<double>& values,
                          std::vector<double>& positions, std::vector<std::string>* unknown) const {
  if (names.size() != values.size()) {
    throw InputError(
        fmt::format("joint positions: {} names, but {} values", names.size(), values.size()));
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!std::isfinite(values[i])) {
      throw InputError(
          fmt::format("position of joint '{}' is {}, but must be finite", names[i], values[i]));
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (const std::optional<int> index = joint_index(names[i])) {
      positions.at(static_cast<std::size_t>(*index)) = values[i];
    } else if (unknown != nullptr && data_->passive_joints.count(names[i]) == 0 &&
               !index_of(*unknown, names[i])) {
      unknown->push_back(names[i]);
    }
  }
}

void Robot::link_poses(const std::vector<double>& positions,
                       std::vector<Eigen::Isometry3d>& poses) const {
  const std::lock_guard<std::mutex> lock(data_->segments_in_use);
  poses.resize(data_->links.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Data::Link& link = data_->links[i];
    if (link.parent < 0) {
      poses[i] = data_->world_from_base;
      continue;
    }
    const double position =
        link.joint < 0
            ? 0.0
            : link.multiplier * positions[static_cast<std::size_t>(link.joint)] + link.offset;
    poses[i] =
        poses[static_cast<std::size_t>(link.parent)] * to_isometry(link.segment.pose(position));
  }
}

Eigen::Isometry3d Robot::link_pose(const std::string& link,
                                   const std::vector<double>& positions) const {
  const std::optional<int> index = link_index(link);
  if (!index) throw InputError(unknown_name_message("link", link, link_names()));
  std::vector<double> checked = initial_positions();
  set_positions(joint_names(), positions, checked);
  std::vector<Eigen::Isometry3d> poses;
  link_poses(checked, poses);
  return poses[static_cast<std::size_t>(*index)];
}

std::vector<Obstacle> Robot::make_obstacles() const {
  std::vector<Eigen::Isometry3d> poses;
  link_poses(initial_positions(), poses);
  std::vector<Obstacle> obstacles;
  for (const Data::Collision& collision : data_->collisions) {
    Obstacle obstacle;
    obstacle.name = collision.name;
    obstacle.shape = collision.shape;
    obstacle.link = data_->link_names[static_cast<std::size_t>(collision.link)];
    obstacle.link_from_shape = collision.link_from_shape;
    obstacle.pose_end = poses[static_cast<std::size_t>(collision.link)] * collision.link_from_shape;
    obstacle.pose_start = obstacle.pose_end;
    obstacles.push_back(std::move(obstacle));
  }
  return obstacles;
}

}  // namespace pliant
