#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/obstacle.h"
#include "pliant/scene/robot/link_choice.h"
#include "pliant/scene/robot/link_colliders.h"
#include "pliant/scene/robot/packages.h"

namespace pliant {

/// What becomes of a joint position beyond its limits. kRefuse: what is known before a run is
/// refused; what comes during one is taken with a warning.
enum class JointLimitRule { kRefuse, kClamp, kWarn, kIgnore };

/// How a URDF becomes a robot.
struct RobotOptions {
  PackageResolver resolver;    ///< finds package:// meshes; null: find_package()
  std::string prefix;          ///< before the names of all links and joints
  LinkChoice touching;         ///< links whose shapes become obstacles; no other mesh is read
  bool has_shapes = true;      ///< false: no mesh is read, and it touches nothing
  bool visual_shapes = false;  ///< a link without a collision shape takes its visual ones
  JointLimitRule limit_rule = JointLimitRule::kRefuse;
  LinkColliders colliders;  ///< what solids meshes stand for; by names with the prefix or without
};

/// A robot from a URDF: its links' poses for given joint positions, and its collision shapes as
/// obstacles. Const members may be called from several threads.
///
/// Joints are the movable ones that mimic no other; positions [m] or [rad] follow joint_names().
/// Floating and planar joints are free_joints(): they have a pose instead of a position.
class Robot {
 public:
  struct Limits {
    double lower;  ///< -infinity for a continuous joint
    double upper;
    /// [m/s] or [rad/s]; infinity where the URDF gives none or 0
    double velocity = std::numeric_limits<double>::infinity();
    /// [N] or [N m], likewise
    double effort = std::numeric_limits<double>::infinity();
  };
  struct FreeJoint {
    std::string name, type;  ///< of type "floating" or "planar"
    std::string parent, child;
  };
  /// Where links are that no joint position places.
  struct Placement {
    Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();
    std::vector<Eigen::Isometry3d> free;  ///< parent from child, one for each of free_joints()
  };

  /// Both throw InputError, naming the file (`where`), the line, and the link or joint: what
  /// check_urdf_xml() and check_urdf() refuse, numbers that are not finite, collision shapes of no
  /// size, meshes that are missing, unreadable or without any area (those of
  /// all shapes are told together).
  static Robot from_file(const std::string& path, const RobotOptions& options = {});
  static Robot from_text(const std::string& urdf, const RobotOptions& options = {},
                         const std::string& where = "robot_description");
  /// Without collision shapes, whose meshes are not read: it touches nothing.
  static Robot kinematics_from_text(const std::string& urdf,
                                    const std::string& where = "robot_description");

  Robot(Robot&&) noexcept;
  Robot& operator=(Robot&&) noexcept;
  ~Robot();

  const std::string& name() const;
  const std::string& prefix() const;
  JointLimitRule limit_rule() const;
  /// What is legal in the URDF but surely not meant.
  const std::vector<std::string>& warnings() const;
  const std::vector<std::string>& joint_names() const;
  std::optional<int> joint_index(const std::string& joint) const;
  /// As joint_index(), also by the name without the prefix. Throws InputError for a name that no
  /// joint has, and for a joint that is fixed, mimics another or is free, with what to name
  /// instead.
  int find_joint(const std::string& joint) const;
  /// "mimics 'a'", "is fixed" or "is floating" of a joint that has no position of its own; "" for
  /// all other names.
  std::string why_no_position(const std::string& joint) const;
  /// The joint of joint_names() that moves the joint `mimic`; empty when that mimics none.
  std::optional<int> mimicked_by(const std::string& mimic) const;
  /// Joints that mimic, each with the joint of joint_names() that it follows in the end.
  std::vector<std::pair<std::string, std::string>> mimics() const;
  Limits limits(int joint) const;
  /// With what its motor holds it against what presses on the links [N] or [N m]; infinity, as at
  /// first: it moves as it is told to, whatever presses.
  double effort(int joint) const;
  /// "m" or "rad".
  const char* unit(int joint) const;
  const std::vector<FreeJoint>& free_joints() const;
  /// The root link first, parents before children.
  const std::vector<std::string>& link_names() const;
  std::optional<int> link_index(const std::string& link) const;

  /// World from the root link; the identity at first.
  void set_base_pose(const Eigen::Isometry3d& world_from_base);
  /// The base pose, and the origins of free joints.
  const Placement& initial_placement() const;

  /// Where the joints are until a driver moves them: 0, or the nearest limit to it, at first.
  const std::vector<double>& initial_positions() const;
  /// Throws InputError for what find_joint() refuses, a value that is not finite and, where
  /// limit_rule() says so, one beyond the limits; where that says kClamp, it is put to the nearest.
  void set_initial_position(const std::string& joint, double value);

  /// Every joint has the effort of its limits from now on.
  void limit_efforts();
  /// One joint has this effort. Throws InputError for what find_joint() refuses and for what is not
  /// above 0.
  void limit_effort(const std::string& joint, double effort);

  /// Puts `values` of the joints `names` into `positions` (one for each of joint_names()), as a
  /// sensor_msgs/JointState brings them. Names the robot does not have are left out and appended to
  /// `unknown` unless it is null or has them; fixed, mimicking and free joints are left out. Throws
  /// InputError, and then nothing changed, when sizes differ or a value is not finite.
  void set_positions(const std::vector<std::string>& names, const std::vector<double>& values,
                     std::vector<double>& positions,
                     std::vector<std::string>* unknown = nullptr) const;

  /// World from each link, in the order of link_names(). Allocates nothing once `poses` has its
  /// size. `positions` has one finite value a joint.
  void link_poses(const std::vector<double>& positions,
                  std::vector<Eigen::Isometry3d>& poses) const;
  void link_poses(const std::vector<double>& positions, const Placement& placement,
                  std::vector<Eigen::Isometry3d>& poses) const;
  /// World from `link`. Throws InputError for an unknown link and for positions that are not one
  /// finite value a joint.
  Eigen::Isometry3d link_pose(const std::string& link, const std::vector<double>& positions) const;

  /// A line for each shape that is a mesh: what collider it became, and why.
  std::vector<std::string> collider_notes() const;

  /// One obstacle a shape, named "LINK/collision I" or "LINK/visual I", at the initial positions.
  std::vector<Obstacle> make_obstacles() const;

  struct Data;  // robot_data.h
  const Data& data() const { return *data_; }

 private:
  explicit Robot(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

/// Says where the joints are at a simulated time.
class JointSource {
 public:
  virtual ~JointSource() = default;
  /// `positions` has one value for each of Robot::joint_names() and comes with the last ones; the
  /// source changes those it knows. Called once a step by the thread that steps the world.
  virtual void positions(double time, std::vector<double>& positions) = 0;
};

/// Says where links are that no joint position places.
class PlacementSource {
 public:
  virtual ~PlacementSource() = default;
  /// `placement` comes with the last one; the source changes what it knows. Called as
  /// JointSource::positions().
  virtual void place(double time, Robot::Placement& placement) = 0;
};

}  // namespace pliant
