#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/scene/robot/robot.h"
#include "pliant/scene/robot/robot_tree.h"

namespace pliant {

/// Joint positions of a robot whose hand a user takes. Until then another source says them. From
/// then on the joints move to where the user wants them, all at once and none faster than its URDF
/// allows, and the time of the other source stands still; give_back() moves them back to where that
/// stopped, from where it goes on. World::reset() gives the robot back as well. It belongs to the
/// thread that steps the world.
class RobotHand final : public JointSource {
 public:
  // Of joints whose URDF gives no velocity.
  static constexpr double kAngularSpeed = 1.0;  ///< [rad/s]
  static constexpr double kLinearSpeed = 0.25;  ///< [m/s]

  /// `usual`: null for a robot that stands still until it is taken. `arm`: the joints that move the
  /// hand; `world` outlives this, and its reactions say what fingers feel.
  RobotHand(std::shared_ptr<const Robot> robot, std::shared_ptr<JointSource> usual,
            std::vector<FingerJoint> fingers, const World& world);

  void positions(double time, std::vector<double>& positions) override;

  /// Takes the robot: its joints go to `positions`, but for fingers, which stay as they are. Throws
  /// InputError for positions that are not one finite value a joint.
  void move_to(const std::vector<double>& positions);
  /// Takes the robot. Throws InputError where it has no fingers.
  void open();
  /// Fingers close until one of them feels `force` [N], or to their limits.
  void close(double force);
  /// All joints stay where they are.
  void stop();
  void give_back();

  bool is_taken() const { return state_ != State::kUsual; }
  bool has_usual() const { return usual_ != nullptr; }
  bool has_fingers() const { return !fingers_.empty(); }
  bool is_moving() const { return is_taken() && now_ != goal_; }
  const std::vector<double>& present() const { return now_; }  ///< positions
  const std::vector<double>& goal() const { return goal_; }
  const Robot& robot() const { return *robot_; }

 private:
  enum class State { kUsual, kTaken, kReturning };
  void take();
  void move_fingers(bool open);
  void move_on(double dt);
  double force_on(const FingerJoint& finger) const;

  std::shared_ptr<const Robot> robot_;
  std::shared_ptr<JointSource> usual_;
  std::vector<FingerJoint> fingers_;
  std::vector<std::vector<std::string>> finger_links_;
  std::vector<double> speeds_;
  const World& world_;
  State state_ = State::kUsual;
  std::vector<double> now_, goal_;
  double grip_force_ = 0.0;                                     // [N]; 0: fingers are not closing
  double last_time_ = std::numeric_limits<double>::infinity();  // before the first call [s]
  double held_up_ = 0.0;  // how long the usual source stood still [s]
};

}  // namespace pliant
