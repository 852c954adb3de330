#include "pliant/scene/robot_builder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

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
  if (joint.type == urdf::Joint::CONTINUOUS) {
    const double infinity = std::numeric_limits<double>::infinity();
    return {-infinity, infinity};
  }
  return {joint.limits->lower, joint.limits->upper};
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

/// A collision shape of a link that is still to be made.
struct CollisionToMake {
  const urdf::Geometry* geometry;
  ColliderKind collider;
  std::string where;
};

void add_collisions(const urdf::Link& link, int number, ColliderKind collider,
                    const UrdfPlace& place, Robot::Data& robot,
                    std::vector<CollisionToMake>& to_make) {
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
    to_make.push_back({collision.geometry.get(), collider, where});
    robot.collisions.push_back(std::move(added));
  }
}

/// All of them at the same time; what is wrong with any is told together.
void make_shapes(const std::vector<CollisionToMake>& to_make, const std::string& urdf_path,
                 const PackageResolver& resolver, Robot::Data& robot) {
  std::vector<std::string> faults(to_make.size());
  tbb::parallel_for(std::size_t{0}, to_make.size(), [&](std::size_t k) {
    try {
      const CollisionToMake& one = to_make[k];
      CollisionShape made =
          make_collision_shape(*one.geometry, urdf_path, resolver, one.collider, one.where);
      robot.collisions[k].shape = std::move(made.shape);
      robot.collisions[k].note = std::move(made.note);
    } catch (const InputError& error) {
      faults[k] = error.what();
    }
  });
  faults.erase(std::remove(faults.begin(), faults.end(), ""), faults.end());
  if (!faults.empty()) throw InputError(fmt::format("{}", fmt::join(faults, "\n")));
}

/// Refuses links that the robot does not have, and such without a mesh.
void check_colliders(const LinkColliders& colliders,
                     const std::vector<urdf::LinkConstSharedPtr>& links) {
  std::vector<std::string> with_mesh;
  for (const auto& link : links) {
    const auto& shapes = link->collision_array;
    const bool has_mesh = std::any_of(shapes.begin(), shapes.end(), [](const auto& collision) {
      return collision->geometry != nullptr && collision->geometry->type == urdf::Geometry::MESH;
    });
    if (has_mesh) with_mesh.push_back(link->name);
  }
  for (const auto& [link, kind] : colliders.of_link) {
    if (std::count(with_mesh.begin(), with_mesh.end(), link) > 0) continue;
    throw InputError("robot.colliders: " +
                     unknown_name_message("link with a collision mesh", link, with_mesh));
  }
}

}  // namespace

std::unique_ptr<Robot::Data> build_robot(const std::string& urdf, const std::string& urdf_path,
                                         const PackageResolver& resolver,
                                         const LinkColliders& colliders, const std::string& where) {
  const auto model = parse_urdf(urdf, where);
  const UrdfPlace place = urdf_place(urdf, where);
  const auto links = check_urdf(*model, place);
  KDL::Tree tree;
  if (!kdl_parser::treeFromUrdfModel(*model, tree)) {
    throw InputError(where + ": the robot's links make no kinematic tree");
  }
  auto robot = std::make_unique<Robot::Data>();
  robot->name = model->getName();
  add_joints(links, *robot);
  add_links(*model, tree, links, *robot);
  check_colliders(colliders, links);
  std::vector<CollisionToMake> to_make;
  for (std::size_t i = 0; i < links.size(); ++i) {
    add_collisions(*links[i], static_cast<int>(i), colliders.kind_of(links[i]->name), place, *robot,
                   to_make);
  }
  make_shapes(to_make, urdf_path, resolver, *robot);
  return robot;
}

}  // namespace pliant
