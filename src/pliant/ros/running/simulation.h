#pragma once

#include <ros/time.h>

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pliant/core/body/region.h"
#include "pliant/ros/body_names.h"
#include "pliant/ros/node_parameters.h"
#include "pliant/ros/notices.h"
#include "pliant/ros/robot/placed_frame.h"
#include "pliant/ros/robot/robot_input.h"
#include "pliant/ros/running/command_queue.h"
#include "pliant/ros/running/pacer.h"
#include "pliant/scene/scene.h"

namespace pliant {

/// A world that runs, is paused, or stopped because a step was not finite. Everything here belongs
/// to the simulation thread.
class Simulation {
 public:
  using Clock = std::chrono::steady_clock;

  /// `robots` moves the scene's robots; null leaves them to the scene.
  Simulation(LoadedScene scene, std::shared_ptr<RobotInput> robots,
             const NodeParameters& parameters);

  World& world() { return *scene_.world; }
  const World& world() const { return *scene_.world; }
  const SceneSpec& spec() const { return scene_.spec; }
  /// Never changes: any thread may look at it.
  const BodyNames& names() const { return names_; }
  /// The names of the solvers that run, each once: "xpbd, lbfgs".
  std::string solvers() const;
  bool paused() const { return paused_; }
  /// Why the last step was undone; empty while all is well.
  const std::string& failure() const { return failure_; }
  /// What stands until somebody changes it: what is legal in the scene but surely not meant, and
  /// what is wrong with the motion of its robots.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Of any thread.
  Notices& notices() const { return *notices_; }
  /// Names of the links of all robots. Never changes: any thread may ask.
  const std::vector<std::string>& link_names() const { return link_names_; }
  /// World from a robot's link after the last step. Throws InputError for an unknown one.
  Eigen::Isometry3d link_pose(const std::string& link) const;
  /// Whether there is a robot that does not follow joint_states.
  bool drives_robot() const {
    return !scene_.robots.empty() && !(robots_ && robots_->uses_joint_states());
  }
  /// Appends the robots' links, where the last step left them, but those that follow tf.
  void list_links(std::vector<PlacedFrame>& frames) const;
  /// Root links of robots whose base follows no tf frame.
  std::vector<PlacedFrame> standing_roots() const;
  /// Whether it is known what touched in the last step: not where a GPU took several on end.
  bool knows_contacts() const { return knows_contacts_; }
  /// Simulated time when that is what /clock shows, else ROS time.
  ros::Time now() const;

  /// From now on `driver` moves that robot, which nothing moved before.
  void drive_robot(std::size_t robot, std::unique_ptr<RobotDriver> driver);

  // Requests; each is answered once.
  void pause(const Reply& reply);
  void resume(const Reply& reply);
  void reset(const Reply& reply);
  /// Answered when the steps are made or something else ends them.
  void step(int steps, const Reply& reply);
  /// Answers a step request that is not finished, since the node shuts down.
  void shut_down() { end_step_request(false, "the node is shutting down"); }
  // These throw InputError for what is refused; then nothing changed. `body` is a name that
  // BodyNames knows, and their answers say whom they meant where it is empty.
  /// Of all bodies. A `name` or a `time_integration` that is empty stays.
  Answer switch_solver(const std::string& name, const ParameterText& parameters,
                       const std::string& body, const std::string& time_integration = "");
  /// On the body that is nearest to the force's point. It starts at ROS time `start`; zero or in
  /// the past: now.
  Answer apply_force(AppliedForce force, const ros::Time& start, const std::string& body);
  /// Of all bodies.
  Answer clear_forces(const std::string& body);
  /// Holds the vertices within `region` to `to` ("world", an obstacle or a robot link): those of
  /// the nearest body that has some to hold. An empty name is made up.
  Answer attach(std::string name, const Region& region, const std::string& to, double stiffness,
                const std::string& body);
  /// An empty name: all. Of all bodies.
  Answer detach(const std::string& name, const std::string& body);
  /// Of all bodies that have the field.
  Answer set_field(FieldRequest request, const std::string& body);

  /// When the next step may be made; none while it is paused or waits for the robot.
  std::optional<Clock::time_point> next_step();
  using Seen = std::function<void()>;
  /// One step; of a step request several, where the solver takes them on end. Calls `seen` after
  /// each, or after each few of these, the next ones being under way; what `next_readback` said
  /// before them is then at hand (World::advance()). `alone`: no such several. Returns false when a
  /// step was undone; the simulation is paused then.
  bool make_step(
      const Seen& seen = {},
      const World::NextReadback& next_readback = [] { return Readback::kState; },
      bool alone = false);
  /// Wall time, of steps that are taken on end.
  double seconds_between_observations() const;
  /// Puts the robots where their first joint states and tf say, once these are there or were waited
  /// for long enough. Returns whether steps may be made.
  bool robot_is_ready();
  double last_step_seconds() const { return last_step_seconds_; }  ///< wall time

 private:
  /// Empty when a request for so many steps is fine.
  std::string reason_not_to_step(int steps) const;
  /// Of the next make_step().
  int steps_at_once();
  void fail(const std::string& message);
  /// Whether a robot's sender that follows /clock is late, and was not waited for long enough.
  bool waits_for_senders();
  /// Finds warnings() anew, now and then, and logs new ones.
  void refresh_warnings();
  void log_once(const std::string& note);
  /// What a request is answered that went well, with warnings() behind it as they are now.
  std::string with_warnings(std::string answer);
  void end_step_request(bool success, const std::string& message);

  LoadedScene scene_;
  BodyNames names_;
  std::unique_ptr<Notices> notices_ = std::make_unique<Notices>();
  std::vector<std::string> link_names_;
  std::shared_ptr<RobotInput> robots_;  // null without
  bool robots_are_driven_ = false;
  bool knows_contacts_ = true;
  Clock::time_point robots_deadline_;
  std::optional<Clock::time_point> senders_deadline_;  // while it waits for one
  Clock::time_point next_notes_;
  Pacer pacer_;
  bool paused_;
  bool publish_clock_;
  std::vector<std::string> warnings_;
  std::set<std::string> logged_;  // of warnings_
  std::string failure_;
  double last_step_seconds_ = 0.0;
  int requested_steps_ = 0;  // of the step request
  int steps_left_ = 0;
  Reply step_reply_;  // null without a step request
};

}  // namespace pliant
