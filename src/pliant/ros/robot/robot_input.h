#pragma once

#include <sensor_msgs/JointState.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "pliant/ros/robot/joint_state_source.h"
#include "pliant/ros/robot/tf_placement_source.h"
#include "pliant/scene/scene.h"

namespace pliant {

/// What moves the robots of a scene in a node: joint_states or keyframes, and tf.
class RobotInput {
 public:
  /// `stamps_are_simulated`: of joint_states and tf, since this node publishes /clock. `frames`
  /// outlives this.
  RobotInput(const LoadedScene& scene, bool use_joint_states, bool stamps_are_simulated,
             const FrameTransformer& frames);

  /// Whether there are robots that follow joint_states.
  bool uses_joint_states() const { return uses_joint_states_; }
  /// Takes joint_states over, from any thread. One that is refused changes nothing; that is logged
  /// (at most once in 5 s of wall time).
  void on_message(const sensor_msgs::JointStateConstPtr& message);

  /// What has not come yet of all that the robots follow, as a user would read it; thread-safe.
  std::vector<std::string> missing() const;
  /// Adds the drivers to the world of the scene that this was made of. Once.
  void drive(LoadedScene& scene);
  /// Whether a step from `time` [s] would run ahead of what moves a robot, which follows this
  /// node's /clock and is late. Of the thread that steps the world.
  bool runs_ahead(double time) const;
  /// Begins to wait for what is late at `time` [s]; for how long at most [s of wall time]. Of that
  /// thread.
  double begin_waiting(double time);
  /// Goes on without what is late at `time` [s]. Of that thread.
  void stop_waiting(double time);
  /// What is wrong with the robots' motion: what is missing(), joints that no robot or no message
  /// has, limits that are exceeded, jumps, joints that stall now. Of the thread that steps the
  /// world.
  std::vector<std::string> notes() const;
  /// What was told of the robots' joints so far, over by now or not. Of that thread.
  std::vector<std::string> told() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Moved {
    std::shared_ptr<const Robot> robot;
    std::shared_ptr<JointStateSource> joint_states;  // null without
    std::shared_ptr<JointSource> keyframes;          // null without
    std::shared_ptr<TfPlacementSource> placement;    // null without
    const RobotDriver* driver = nullptr;
  };
  void note_names(const std::vector<std::string>& names);
  std::string unknown_joint(const std::string& joint) const;
  static std::string stopped(const Moved& moved);
  void add_untold(std::vector<std::string>& notes) const;

  std::vector<Moved> robots_;
  bool uses_joint_states_;

  mutable std::mutex mutex_;
  std::set<std::string> names_;       // guarded by mutex_: of all messages
  std::vector<std::string> unknown_;  // guarded by mutex_: notes of joints that no robot has
  Clock::time_point first_message_;   // guarded by mutex_
  bool received_ = false;             // guarded by mutex_
  Clock::time_point last_warning_;    // of the thread that takes messages
};

}  // namespace pliant
