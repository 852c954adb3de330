#include "pliant/scene/robot/robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"
#include "pliant/scene/robot/robot_builder.h"
#include "pliant/scene/robot/robot_data.h"
#include "pliant/scene/robot/urdf_reader.h"
#include "pliant/scene/yaml/text_file.h"

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

Robot Robot::from_file(const std::string& path, const RobotOptions& options) {
  return Robot(build_robot(read_text_file(path, kMaxUrdfBytes), path, options, path));
}

Robot Robot::from_text(const std::string& urdf, const RobotOptions& options,
                       const std::string& where) {
  return Robot(build_robot(urdf, "", options, where));
}

Robot Robot::kinematics_from_text(const std::string& urdf, const std::string& where) {
  RobotOptions options;
  options.has_shapes = false;
  return from_text(urdf, options, where);
}

const std::string& Robot::name() const { return data_->name; }
const std::string& Robot::prefix() const { return data_->prefix; }
JointLimitRule Robot::limit_rule() const { return data_->limit_rule; }
const std::vector<std::string>& Robot::warnings() const { return data_->warnings; }
const std::vector<Robot::FreeJoint>& Robot::free_joints() const { return data_->free_joints; }
const Robot::Placement& Robot::initial_placement() const { return data_->placement; }
const std::vector<std::string>& Robot::joint_names() const { return data_->joint_names; }
const std::vector<std::string>& Robot::link_names() const { return data_->link_names; }
const std::vector<double>& Robot::initial_positions() const { return data_->initial; }

std::optional<int> Robot::joint_index(const std::string& joint) const {
  return index_of(data_->joint_names, joint);
}

int Robot::find_joint(const std::string& joint) const {
  for (const std::string& name : {joint, prefix() + joint}) {
    if (const std::optional<int> index = joint_index(name)) return *index;
    const std::string why = why_no_position(name);
    if (why.empty()) continue;
    const std::optional<int> mimicked = mimicked_by(name);
    throw InputError(fmt::format(
        "joint '{}' {} and has no position of its own{}", joint, why,
        mimicked ? ": name '" + joint_names()[static_cast<std::size_t>(*mimicked)] + "' instead"
                 : ": leave it out"));
  }
  throw InputError(unknown_name_message("joint", joint, joint_names()));
}

std::string Robot::why_no_position(const std::string& joint) const {
  const auto found = data_->passive_joints.find(joint);
  return found == data_->passive_joints.end() ? "" : found->second.why;
}

std::optional<int> Robot::mimicked_by(const std::string& mimic) const {
  const auto found = data_->passive_joints.find(mimic);
  if (found == data_->passive_joints.end() || found->second.mimicked < 0) return std::nullopt;
  return found->second.mimicked;
}

std::vector<std::pair<std::string, std::string>> Robot::mimics() const {
  std::vector<std::pair<std::string, std::string>> found;
  for (const auto& [name, joint] : data_->passive_joints) {
    if (joint.mimicked < 0) continue;
    found.emplace_back(name, data_->joint_names[static_cast<std::size_t>(joint.mimicked)]);
  }
  return found;
}

const char* Robot::unit(int joint) const {
  return data_->is_prismatic.at(static_cast<std::size_t>(joint)) ? "m" : "rad";
}

std::optional<int> Robot::link_index(const std::string& link) const {
  return index_of(data_->link_names, link);
}

Robot::Limits Robot::limits(int joint) const {
  return data_->limits.at(static_cast<std::size_t>(joint));
}

double Robot::effort(int joint) const { return data_->efforts.at(static_cast<std::size_t>(joint)); }

void Robot::limit_efforts() {
  for (std::size_t j = 0; j < data_->efforts.size(); ++j) {
    data_->efforts[j] = data_->limits[j].effort;
  }
}

void Robot::limit_effort(const std::string& joint, double effort) {
  const int index = find_joint(joint);
  if (!(effort > 0.0)) {
    throw InputError(
        fmt::format("the effort of joint '{}' is {}, but must be above 0", joint, effort));
  }
  data_->efforts[static_cast<std::size_t>(index)] = effort;
}

void Robot::set_base_pose(const Eigen::Isometry3d& world_from_base) {
  data_->placement.world_from_base = world_from_base;
}

void Robot::set_initial_position(const std::string& joint, double value) {
  const int index = find_joint(joint);
  const Limits range = limits(index);
  const bool is_within = value >= range.lower && value <= range.upper;
  if (!std::isfinite(value) || (!is_within && limit_rule() == JointLimitRule::kRefuse)) {
    throw InputError(fmt::format(
        "joint '{}' is {}, but must be from {:g} to {:g} [m or rad]{}", joint, value, range.lower,
        range.upper,
        std::isfinite(value) ? "; 'limits: clamp' or 'limits: warn' takes it all the same" : ""));
  }
  if (limit_rule() == JointLimitRule::kClamp) value = std::clamp(value, range.lower, range.upper);
  data_->initial[static_cast<std::size_t>(index)] = value;
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
  link_poses(positions, data_->placement, poses);
}

void Robot::link_poses(const std::vector<double>& positions, const Placement& placement,
                       std::vector<Eigen::Isometry3d>& poses) const {
  const std::lock_guard<std::mutex> lock(data_->segments_in_use);
  poses.resize(data_->links.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Data::Link& link = data_->links[i];
    if (link.parent < 0) {
      poses[i] = placement.world_from_base;
      continue;
    }
    if (link.free >= 0) {
      poses[i] = poses[static_cast<std::size_t>(link.parent)] *
                 placement.free[static_cast<std::size_t>(link.free)];
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

std::vector<std::string> Robot::collider_notes() const {
  std::vector<std::string> notes;
  for (const Data::Collision& collision : data_->collisions) {
    if (!collision.note.empty()) notes.push_back(collision.name + ": " + collision.note);
  }
  return notes;
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
    obstacle.color = collision.color;
    obstacle.pose_end = poses[static_cast<std::size_t>(collision.link)] * collision.link_from_shape;
    obstacle.pose_start = obstacle.pose_end;
    obstacles.push_back(std::move(obstacle));
  }
  return obstacles;
}

}  // namespace pliant
