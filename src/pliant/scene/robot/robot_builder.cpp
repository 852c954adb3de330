#include "pliant/scene/robot/robot_builder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <kdl/tree.hpp>
#include <limits>
#include <map>

#include "pliant/math/error.h"
#include "pliant/scene/robot/robot_collision.h"
#include "pliant/scene/robot/urdf_reader.h"
#include "pliant/scene/robot_library.h"

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
  Robot::Limits limits = {-infinity, infinity, infinity, infinity};
  if (joint.type != urdf::Joint::CONTINUOUS) {
    limits.lower = joint.limits->lower;
    limits.upper = joint.limits->upper;
  }
  if (joint.limits == nullptr) return limits;
  // Many URDFs write 0 for what they do not know.
  if (joint.limits->velocity > 0.0) limits.velocity = joint.limits->velocity;
  if (joint.limits->effort > 0.0) limits.effort = joint.limits->effort;
  return limits;
}

/// Of the first visual shape that has a colour: it is the link's, whatever shapes touch.
Eigen::Vector4f color_of(const urdf::Link& link) {
  for (const auto& visual : link.visual_array) {
    if (visual->material == nullptr || !visual->material->texture_filename.empty()) continue;
    const urdf::Color& color = visual->material->color;
    if (color.a > 0.0f) return {color.r, color.g, color.b, color.a};
  }
  return Obstacle().color;
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

/// Reads one URDF into a robot.
class RobotBuilder {
 public:
  RobotBuilder(const urdf::ModelInterface& model, const UrdfLines& lines,
               const std::vector<urdf::LinkConstSharedPtr>& links, const RobotOptions& options,
               Robot::Data& robot)
      : model_(model), lines_(lines), links_(links), options_(options), robot_(robot) {}

  void add_joints() {
    for (const auto& link : links_) {
      const auto& joint = link->parent_joint;
      if (joint == nullptr) continue;
      if (is_active(*joint)) {
        add_active(*joint);
      } else if (is_free(*joint)) {
        add_free(*joint);
      }
    }
    for (const auto& link : links_) {
      const auto& joint = link->parent_joint;
      if (joint != nullptr && !is_active(*joint)) add_passive(*joint);
    }
  }

  void add_links(const KDL::Tree& tree) {
    std::map<std::string, int> numbers;
    for (const auto& urdf_link : links_) {
      Robot::Data::Link link;
      if (urdf_link->parent_joint != nullptr) {
        const urdf::Joint& joint = *urdf_link->parent_joint;
        link.parent = numbers.at(joint.parent_link_name);
        link.segment = GetTreeElementSegment(tree.getSegment(urdf_link->name)->second);
        if (is_free(joint)) {
          link.free = free_.at(joint.name);
        } else if (joint.type != urdf::Joint::FIXED) {
          follow_mimics(model_, &joint, joints_, link);
        }
      }
      numbers[urdf_link->name] = static_cast<int>(robot_.links.size());
      robot_.link_names.push_back(full(urdf_link->name));
      robot_.links.push_back(link);
    }
  }

  void add_shapes(const std::string& urdf_path) {
    const std::vector<bool> touching = options_.touching.choose(robot_.link_names, options_.prefix);
    for (std::size_t i = 0; i < links_.size(); ++i) {
      if (!touching[i]) continue;
      const urdf::Link& link = *links_[i];
      const UrdfLines::Link& written = lines_.links.at(link.name);
      if (!link.collision_array.empty() || !options_.visual_shapes) {
        add_shapes(link.collision_array, "collision", written.collisions, i);
      } else {
        add_shapes(link.visual_array, "visual", written.visuals, i);
      }
    }
    check_colliders();
    make_shapes(urdf_path);
  }

 private:
  std::string full(const std::string& name) const { return options_.prefix + name; }

  void add_active(const urdf::Joint& joint) {
    const Robot::Limits limits = limits_of(joint);
    joints_[joint.name] = static_cast<int>(robot_.joint_names.size());
    robot_.joint_names.push_back(full(joint.name));
    robot_.limits.push_back(limits);
    robot_.efforts.push_back(std::numeric_limits<double>::infinity());
    robot_.is_prismatic.push_back(joint.type == urdf::Joint::PRISMATIC);
    robot_.initial.push_back(std::clamp(0.0, limits.lower, limits.upper));
  }

  void add_free(const urdf::Joint& joint) {
    free_[joint.name] = static_cast<int>(robot_.free_joints.size());
    robot_.free_joints.push_back({full(joint.name),
                                  joint.type == urdf::Joint::FLOATING ? "floating" : "planar",
                                  full(joint.parent_link_name), full(joint.child_link_name)});
    robot_.placement.free.push_back(to_isometry(joint.parent_to_joint_origin_transform));
  }

  void add_passive(const urdf::Joint& joint) {
    Robot::Data::PassiveJoint passive;
    if (joint.mimic != nullptr) {
      Robot::Data::Link followed;
      follow_mimics(model_, &joint, joints_, followed);
      passive.mimicked = followed.joint;
      passive.why = "mimics '" + full(joint.mimic->joint_name) + "'";
    } else if (is_free(joint)) {
      passive.why = "is " + robot_.free_joints[static_cast<std::size_t>(free_.at(joint.name))].type;
    } else {
      passive.why = "is fixed";
    }
    robot_.passive_joints[full(joint.name)] = passive;
  }

  /// `shapes`: the link's elements of that kind, written in `lines`.
  template <class Shapes>
  void add_shapes(const Shapes& shapes, const char* kind, const std::vector<int>& lines,
                  std::size_t link) {
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const std::string& name = robot_.link_names[link];
      const std::string where =
          fmt::format("{}: link '{}' {} {}", lines_.at(lines.at(i)), name, kind, i);
      Robot::Data::Collision added;
      added.name = fmt::format("{}/{} {}", name, kind, i);
      added.link = static_cast<int>(link);
      added.link_from_shape = to_isometry(shapes[i]->origin);
      added.color = color_of(*links_[link]);
      to_make_.push_back({shapes[i]->geometry.get(), collider_of(link), where});
      robot_.collisions.push_back(std::move(added));
    }
  }

  /// The part of a link's name that follows the prefix stands for it too.
  ColliderKind collider_of(std::size_t link) const {
    const std::string& name = robot_.link_names[link];
    const auto& named = options_.colliders.of_link;
    return options_.colliders.kind_of(named.count(name) > 0 ? name
                                                            : name.substr(options_.prefix.size()));
  }

  /// Refuses links that the robot does not have, and such without a mesh that is touched.
  void check_colliders() const {
    std::vector<std::string> with_mesh;
    for (std::size_t k = 0; k < to_make_.size(); ++k) {
      if (to_make_[k].geometry->type != urdf::Geometry::MESH) continue;
      with_mesh.push_back(robot_.link_names[static_cast<std::size_t>(robot_.collisions[k].link)]);
    }
    for (const auto& [link, kind] : options_.colliders.of_link) {
      if (std::count(with_mesh.begin(), with_mesh.end(), link) > 0 ||
          std::count(with_mesh.begin(), with_mesh.end(), full(link)) > 0) {
        continue;
      }
      throw InputError("colliders: " +
                       unknown_name_message("link with a collision mesh", link, with_mesh));
    }
  }

  /// All of them at the same time; what is wrong with any is told together.
  void make_shapes(const std::string& urdf_path) {
    std::vector<std::string> faults(to_make_.size());
    tbb::parallel_for(std::size_t{0}, to_make_.size(), [&](std::size_t k) {
      try {
        const ShapeToMake& one = to_make_[k];
        CollisionShape made = make_collision_shape(*one.geometry, urdf_path, options_.resolver,
                                                   one.collider, one.where);
        robot_.collisions[k].shape = std::move(made.shape);
        robot_.collisions[k].note = std::move(made.note);
      } catch (const InputError& error) {
        faults[k] = error.what();
      }
    });
    faults.erase(std::remove(faults.begin(), faults.end(), ""), faults.end());
    if (!faults.empty()) throw InputError(fmt::format("{}", fmt::join(faults, "\n")));
  }

  /// A shape that is still to be made, of the collision of the same number.
  struct ShapeToMake {
    const urdf::Geometry* geometry;
    ColliderKind collider;
    std::string where;
  };

  const urdf::ModelInterface& model_;
  const UrdfLines& lines_;
  const std::vector<urdf::LinkConstSharedPtr>& links_;
  const RobotOptions& options_;
  Robot::Data& robot_;
  std::map<std::string, int> joints_, free_;  // by their names in the URDF
  std::vector<ShapeToMake> to_make_;
};

/// KDL warns of inertia of the root link, and of floating and planar joints, which it takes for
/// fixed ones: neither matters here, since the tree gives the motion of the other joints alone.
KDL::Tree make_tree(urdf::ModelInterface& model, const std::string& where) {
  std::vector<std::pair<urdf::Joint*, int>> free;
  for (const auto& entry : model.joints_) {
    urdf::Joint& joint = *entry.second;
    if (!is_free(joint)) continue;
    free.emplace_back(&joint, joint.type);
    joint.type = urdf::Joint::FIXED;
  }
  model.root_link_->inertial = nullptr;
  KDL::Tree tree;
  const bool is_tree = robot_function<MakeRobotTree>(kMakeRobotTree)(model, tree);
  for (const auto& [joint, type] : free) joint->type = static_cast<decltype(joint->type)>(type);
  if (!is_tree) throw InputError(where + ": the robot's links make no kinematic tree");
  return tree;
}

}  // namespace

std::unique_ptr<Robot::Data> build_robot(const std::string& urdf, const std::string& urdf_path,
                                         const RobotOptions& options, const std::string& where) {
  const ParsedUrdf parsed = parse_urdf(urdf, where);
  const auto links = check_urdf(*parsed.model, parsed.xml.lines);
  const KDL::Tree tree = make_tree(*parsed.model, where);
  auto robot = std::make_unique<Robot::Data>();
  robot->name = parsed.model->getName();
  robot->prefix = options.prefix;
  robot->limit_rule = options.limit_rule;
  robot->warnings = parsed.xml.warnings;
  RobotBuilder builder(*parsed.model, parsed.xml.lines, links, options, *robot);
  builder.add_joints();
  builder.add_links(tree);
  if (options.has_shapes) builder.add_shapes(urdf_path);
  return robot;
}

}  // namespace pliant
