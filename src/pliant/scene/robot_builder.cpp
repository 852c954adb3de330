#include "pliant/scene/robot_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <kdl/tree.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <limits>
#include <map>

#include "pliant/math/error.h"
#include "pliant/scene/robot_collision.h"
#include "pliant/scene/urdf_reader.h"

namespace pliant {
namespace {

Eigen::Isometry3d to_isometry(const urdf::Pose& pose) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translation() << pose.position.x, pose.position.y, pose.position.z;
  const urdf::Rotation& q = pose.rotation;
  result.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  return result;
}

Robot::Limits limits_of(const urdf::Joint& joint) {
  const double infinity = std::numeric_limits<double>::infinity();
  Robot::Limits limits = {-infinity, infinity, infinity};
  if (joint.type != urdf::Joint::CONTINUOUS) {
    limits.lower = joint.limits->lower;
    limits.upper = joint.limits->upper;
  }
  // Many URDFs write 0 for what they do not know.
  const bool is_known = joint.limits != nullptr && joint.limits->velocity > 0.0;
  if (is_known) limits.velocity = joint.limits->velocity;
  return limits;
}

/// The joint that moves `link`, following mimics: angle = multiplier * position + offset.
void follow_mimics(const urdf::ModelInterface& model, const urdf::Joint* joint,
                   const std::map<std::string, int>& joints, Robot::Data::Link& link) {
  while (joint->mimic != nullptr) {
    link.offset += link.multiplier * joint->mimic->offset;
    link.multiplier *= joint->mimic->multiplier;
    joint = model.joints_.at(joint->mimic->joint_name).get();
  }
  const auto found = joints.find(joint->name);
  if (found != joints.end()) link.joint = found->second;
}

void add_joints(const std::vector<urdf::LinkConstSharedPtr>& links, Robot::Data& robot) {
  for (const auto& link : links) {
    const auto& joint = link->parent_joint;
    if (joint == nullptr) continue;
    if (!is_active(*joint)) {
      robot.passive_joints.insert(joint->name);
      continue;
    }
    const Robot::Limits limits = limits_of(*joint);
    robot.joint_names.push_back(joint->name);
    robot.limits.push_back(limits);
    robot.initial.push_back(std::clamp(0.0, limits.lower, limits.upper));
  }
}

void add_links(const urdf::ModelInterface& model, const KDL::Tree& tree,
               const std::vector<urdf::LinkConstSharedPtr>& links, Robot::Data& robot) {
  std::map<std::string, int> joints, numbers;
  for (std::size_t j = 0; j < robot.joint_names.size(); ++j) {
    joints[robot.joint_names[j]] = static_cast<int>(j);
  }
  for (const auto& urdf_link : links) {
    Robot::Data::Link link;
    if (urdf_link->parent_joint != nullptr) {
      link.parent = numbers.at(urdf_link->parent_joint->parent_link_name);
      link.segment = GetTreeElementSegment(tree.getSegment(urdf_link->name)->second);
      const urdf::Joint& joint = *urdf_link->parent_joint;
      if (joint.type != urdf::Joint::FIXED) follow_mimics(model, &joint, joints, link);
    }
    numbers[urdf_link->name] = static_cast<int>(robot.links.size());
    robot.link_names.push_back(urdf_link->name);
    robot.links.push_back(link);
  }
}

void add_collisions(const urdf::Link& link, int number, const std::string& urdf_path,
                    const PackageResolver& resolver, const UrdfPlace& place, Robot::Data& robot) {
  for (std::size_t i = 0; i < link.collision_array.size(); ++i) {
    const urdf::Collision& collision = *link.collision_array[i];
    const std::string where =
        fmt::format("{}: link '{}' collision {}", place("link", link.name), link.name, i);
    if (collision.geometry == nullptr) throw InputError(where + ": it has no geometry");
    Robot::Data::Collision added;
    added.name = fmt::format("{}/collision {}", link.name, i);
    added.link = number;
    added.link_from_shape = to_isometry(collision.origin);
    if (!added.link_from_shape.matrix().allFinite()) {
      throw InputError(where + ": its origin is not finite");
    }
    added.shape = make_collision_shape(*collision.geometry, urdf_path, resolver, where);
    robot.collisions.push_back(std::move(added));
  }
}

struct ParsedRobot {
  std::unique_ptr<Robot::Data> robot;
  std::vector<urdf::LinkConstSharedPtr> links;
};

ParsedRobot parse_robot(const std::string& urdf, const UrdfPlace& place, const std::string& where) {
  const auto model = parse_urdf(urdf, where);
  ParsedRobot parsed{std::make_unique<Robot::Data>(), check_urdf(*model, place)};
  KDL::Tree tree;
  if (!kdl_parser::treeFromUrdfModel(*model, tree)) {
    throw InputError(where + ": the robot's links make no kinematic tree");
  }
  parsed.robot->name = model->getName();
  add_joints(parsed.links, *parsed.robot);
  add_links(*model, tree, parsed.links, *parsed.robot);
  return parsed;
}

}  // namespace

std::unique_ptr<Robot::Data> build_robot(const std::string& urdf, const std::string& urdf_path,
                                         const PackageResolver& resolver,
                                         const std::string& where) {
  const UrdfPlace place = urdf_place(urdf, where);
  auto [robot, links] = parse_robot(urdf, place, where);
  for (std::size_t i = 0; i < links.size(); ++i) {
    add_collisions(*links[i], static_cast<int>(i), urdf_path, resolver, place, *robot);
  }
  return std::move(robot);
}

std::unique_ptr<Robot::Data> build_kinematics(const std::string& urdf, const std::string& where) {
  return parse_robot(urdf, urdf_place(urdf, where), where).robot;
}

}  // namespace pliant
