#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/obstacle.h"
#include "pliant/scene/packages.h"

namespace pliant {

/// A robot from a URDF: its links' poses for given joint positions, and its collision shapes as
/// obstacles. Const members may be called from several threads.
///
/// Joints are the movable ones that mimic no other; positions [m] or [rad] follow joint_names().
class Robot {
 public:
  struct Limits {
    double lower;  ///< -infinity for a continuous joint
    double upper;
    /// [m/s] or [rad/s]; infinity where the URDF gives none or 0
    double velocity = std::numeric_limits<double>::infinity();
  };

  /// `resolver` finds package:// meshes; null: find_package().
  /// Both throw InputError, naming the file (`where`) and the link or joint: URDF that is broken or
  /// not one tree, joints other than fixed, revolute, continuous, prismatic, a mimic of a joint
  /// that is not there, numbers that are not finite, collision shapes of no size, meshes that are
  /// missing, unreadable or not closed.
  static Robot from_file(const std::string& path, const PackageResolver& resolver = nullptr);
  static Robot from_text(const std::string& urdf, const PackageResolver& resolver = nullptr,
                         const std::string& where = "robot_description");
  /// Without collision shapes, whose meshes are not read: it touches nothing.
  static Robot kinematics_from_text(const std::string& urdf,
                                    const std::string& where = "robot_description");

  Robot(Robot&&) noexcept;
  Robot& operator=(Robot&&) noexcept;
  ~Robot();

  const std::string& name() const;
  const std::vector<std::string>& joint_names() const;
  std::optional<int> joint_index(const std::string& joint) const;
  Limits limits(int joint) const;
  /// The root link first, parents before children.
  const std::vector<std::string>& link_names() const;
  std::optional<int> link_index(const std::string& link) const;

  /// World from the root link; the identity at first.
  void set_base_pose(const Eigen::Isometry3d& world_from_base);

  /// Where the joints are until a driver moves them: 0, or the nearest limit to it, at first.
  const std::vector<double>& initial_positions() const;
  /// Throws InputError for an unknown joint and a value that is not finite or beyond its limits.
  void set_initial_position(const std::string& joint, double value);

  /// Puts `values` of the joints `names` into `positions` (one for each of joint_names()), as a
  /// sensor_msgs/JointState brings them. Names the robot does not have are left out and appended to
  /// `unknown` unless it is null or has them; fixed and mimicking joints are left out. Throws
  /// InputError, and then nothing changed, when sizes differ or a value is not finite.
  void set_positions(const std::vector<std::string>& names, const std::vector<double>& values,
                     std::vector<double>& positions,
                     std::vector<std::string>* unknown = nullptr) const;

  /// World from each link, in the order of link_names(). Allocates nothing once `poses` has its
  /// size. `positions` has one finite value a joint.
  void link_poses(const std::vector<double>& positions,
                  std::vector<Eigen::Isometry3d>& poses) const;
  /// World from `link`. Throws InputError for an unknown link and for positions that are not one
  /// finite value a joint.
  Eigen::Isometry3d link_pose(const std::string& link, const std::vector<double>& positions) const;

  /// One obstacle a collision shape, named "LINK/collision I", at the initial positions.
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

/// Moves the obstacles of a robot's links as a source of joint positions says. A position that is
/// not finite is left out: the joint stays where it is. drive() allocates nothing after its first
/// call.
class RobotDriver final : public ObstacleDriver {
 public:
  RobotDriver(std::shared_ptr<const Robot> robot, std::shared_ptr<JointSource> source);
  void drive(double time, std::vector<Obstacle>& obstacles) override;
  /// Of the last drive(); the initial ones before.
  const std::vector<double>& positions() const { return positions_; }

 private:
  void find_links(const std::vector<Obstacle>& obstacles);

  std::shared_ptr<const Robot> robot_;
  std::shared_ptr<JointSource> source_;
  std::vector<double> positions_, requested_;
  std::vector<Eigen::Isometry3d> poses_;
  std::vector<int> link_of_obstacle_;  // -1 for what is no link of the robot
};

}  // namespace pliant
