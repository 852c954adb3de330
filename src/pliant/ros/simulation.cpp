#include "pliant/ros/simulation.h"

#include <fmt/format.h>
#include <ros/console.h>

#include <algorithm>

namespace pliant {
namespace {

constexpr int kMaxSteps = 10'000'000;
// Of a step request that a GPU takes on end: between two looks at commands, and at what is to be
// published. Numbers of their own, since the last bits of a state depend on them.
constexpr int kMostAtOnce = 60, kBetweenLooks = 10;

Simulation::Clock::duration seconds(double value) {
  return std::chrono::duration_cast<Simulation::Clock::duration>(
      std::chrono::duration<double>(value));
}

}  // namespace

Simulation::Simulation(LoadedScene scene, std::shared_ptr<JointStateSource> joints,
                       const NodeParameters& parameters)
    : scene_(std::move(scene)),
      names_(scene_.world->bodies()),
      joints_(std::move(joints)),
      follows_joint_states_(joints_ != nullptr),
      joints_deadline_(Clock::now() + seconds(parameters.joint_states_wait)),
      pacer_(parameters.real_time_limit),
      paused_(parameters.paused),
      publish_clock_(parameters.publish_clock) {}

ros::Time Simulation::now() const {
  return publish_clock_ ? ros::Time(world().time()) : ros::Time::now();
}

void Simulation::pause(const Reply& reply) {
  end_step_request(false, "ended by ~pause");
  const std::string was = paused_ ? "was paused already" : "paused";
  paused_ = true;
  reply->set_value({true, fmt::format("{} at {:.6g} s", was, world().time()), world().time()});
}

void Simulation::resume(const Reply& reply) {
  end_step_request(false, "ended by ~resume");
  // After a failure the first step is tried at once, so that the answer tells whether it helped.
  if (!failure_.empty() && robot_is_ready() && !make_step()) {
    reply->set_value({false, failure_, world().time()});
    return;
  }
  const std::string was = paused_ ? "resumed" : "was running already";
  paused_ = false;
  pacer_.restart(world().time());
  reply->set_value({true, fmt::format("{} at {:.6g} s", was, world().time()), world().time()});
}

void Simulation::reset(const Reply& reply) {
  end_step_request(false, "ended by ~reset");
  world().reset();
  knows_contacts_ = true;
  failure_.clear();
  pacer_.restart(0.0);
  reply->set_value({true, paused_ ? "reset, paused" : "reset, running", 0.0});
}

std::string Simulation::reason_not_to_step(int steps) const {
  if (steps < 1 || steps > kMaxSteps) {
    return fmt::format("'steps' is {}, but must be 1 to {}", steps, kMaxSteps);
  }
  if (!paused_) return "the simulation runs: call ~pause first";
  if (step_reply_) {
    return fmt::format("another ~step request has {} of {} steps to make; ~pause ends it",
                       steps_left_, requested_steps_);
  }
  return "";
}

void Simulation::step(int steps, const Reply& reply) {
  const std::string reason = reason_not_to_step(steps);
  if (!reason.empty()) {
    reply->set_value({false, reason, world().time()});
    return;
  }
  requested_steps_ = steps_left_ = steps;
  step_reply_ = reply;
}

void Simulation::end_step_request(bool success, const std::string& message) {
  if (!step_reply_) return;
  const int made = requested_steps_ - steps_left_;
  steps_left_ = 0;
  step_reply_->set_value(
      {success,
       fmt::format("{} of {} steps made, at {:.6g} s{}{}", made, requested_steps_, world().time(),
                   message.empty() ? "" : "; ", message),
       world().time()});
  step_reply_ = nullptr;
}

void Simulation::drive_robot(std::unique_ptr<RobotDriver> driver) {
  scene_.driver = driver.get();
  world().add_driver(std::move(driver));
}

void Simulation::list_links(std::vector<PlacedFrame>& frames) const {
  if (!scene_.robot) return;
  const Robot& robot = *scene_.robot;
  std::vector<Eigen::Isometry3d> poses;
  robot.link_poses(scene_.driver ? scene_.driver->positions() : robot.initial_positions(), poses);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    frames.push_back({robot.link_names()[k], poses[k]});
  }
}

bool Simulation::robot_is_ready() {
  if (!joints_) return true;
  const bool received = joints_->received();
  if (!received && Clock::now() < joints_deadline_) return false;
  if (!received) ROS_WARN("no joint_states yet: the robot starts at its initial positions");
  auto driver = std::make_unique<RobotDriver>(scene_.robot, std::move(joints_));
  scene_.driver = driver.get();
  world().add_driver(std::move(driver));
  joints_ = nullptr;
  pacer_.restart(world().time());
  return true;
}

std::optional<Simulation::Clock::time_point> Simulation::next_step() {
  if (!robot_is_ready()) return {};
  if (step_reply_) return Clock::time_point::min();
  if (paused_) return {};
  return pacer_.due(world().time());
}

double Simulation::seconds_between_looks() const { return kBetweenLooks * last_step_seconds_; }

int Simulation::steps_at_once() {
  if (!step_reply_) return 1;
  const int wanted = std::min(steps_left_, kMostAtOnce);
  return world().series_limit(wanted) >= 2 ? wanted : 1;
}

bool Simulation::make_step(const Seen& seen, const World::Wants& wants, bool alone) {
  Timer timer;
  std::uint64_t before = world().steps();
  const auto look = [&](const World& now) {
    const auto steps = static_cast<int>(now.steps() - before);
    last_step_seconds_ = timer.seconds() / steps;
    knows_contacts_ = steps == 1;
    if (step_reply_) steps_left_ -= steps;
    failure_.clear();
    if (seen) seen();
    before = now.steps();
    timer = Timer();
    return true;
  };
  try {
    if (!world().advance(alone ? 1 : steps_at_once(), kBetweenLooks, look, wants)) {
      for (const Body& body : world().bodies()) {
        if (!body.report.failure.empty()) fail(body.report.failure);
      }
      return false;
    }
  } catch (const std::exception& error) {
    fail(fmt::format("step at {:.6g} s: {}", world().time(), error.what()));
    return false;
  }
  if (step_reply_ && steps_left_ == 0) end_step_request(true, "");
  return true;
}

void Simulation::fail(const std::string& message) {
  // Said once: trying again without a change fails again.
  if (failure_ != message) ROS_ERROR("paused: %s", message.c_str());
  failure_ = message;
  paused_ = true;
  end_step_request(false, message);
}

}  // namespace pliant
