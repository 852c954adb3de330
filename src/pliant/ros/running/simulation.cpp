#include "pliant/ros/running/simulation.h"

#include <fmt/format.h>
#include <ros/console.h>

#include <algorithm>

#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr int kMaxSteps = 10'000'000;
// Steps of a request that a GPU takes on end: between two looks at commands, and between two
// observations of what is to be published. Numbers of their own, since the last bits of a state
// depend on them.
constexpr int kMostAtOnce = 60, kBetweenObservations = 10;
constexpr double kNotesPeriod = 0.2;  // wall time [s]
// Between two looks whether a sender is still late; wall time.
constexpr auto kBetweenLooksForSenders = std::chrono::milliseconds(1);

Simulation::Clock::duration seconds(double value) {
  return std::chrono::duration_cast<Simulation::Clock::duration>(
      std::chrono::duration<double>(value));
}

/// Others say in tf where it is, and the simulation follows: what it said itself would lead it in a
/// circle.
bool is_placed_by_tf(const Robot& robot, const RobotSpec& spec, const std::string& link) {
  const std::vector<Robot::FreeJoint>& free = robot.free_joints();
  return link == spec.base_frame ||
         std::any_of(free.begin(), free.end(),
                     [&](const Robot::FreeJoint& joint) { return joint.child == link; });
}

}  // namespace

Simulation::Simulation(LoadedScene scene, std::shared_ptr<RobotInput> robots,
                       const NodeParameters& parameters)
    : scene_(std::move(scene)),
      names_(scene_.world->bodies()),
      robots_(std::move(robots)),
      robots_deadline_(Clock::now() + seconds(parameters.joint_states_wait)),
      pacer_(parameters.real_time_limit),
      paused_(parameters.paused),
      publish_clock_(parameters.publish_clock),
      warnings_(scene_.warnings),
      logged_(warnings_.begin(), warnings_.end()) {
  for (const SceneRobot& robot : scene_.robots) {
    const std::vector<std::string>& links = robot.robot->link_names();
    link_names_.insert(link_names_.end(), links.begin(), links.end());
  }
}

Eigen::Isometry3d Simulation::link_pose(const std::string& link) const {
  for (const SceneRobot& robot : scene_.robots) {
    if (robot.robot->link_index(link)) return robot.link_pose(link);
  }
  throw InputError(unknown_name_message("robot link", link, link_names_));
}

void Simulation::log_once(const std::string& note) {
  if (logged_.insert(note).second) ROS_WARN("%s", note.c_str());
}

void Simulation::refresh_warnings() {
  const Clock::time_point now = Clock::now();
  if (!robots_ || now < next_notes_) return;
  next_notes_ = now + seconds(kNotesPeriod);
  warnings_ = scene_.warnings;
  for (const std::string& note : robots_->notes()) {
    warnings_.push_back(note);
    log_once(note);
  }
  for (const std::string& note : robots_->told()) log_once(note);
}

std::string Simulation::with_warnings(std::string answer) {
  next_notes_ = {};
  refresh_warnings();
  for (const std::string& warning : warnings_) answer += "; warning: " + warning;
  return answer;
}

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
  const std::string answer = fmt::format("{} at {:.6g} s", was, world().time());
  reply->set_value({true, with_warnings(answer), world().time()});
}

void Simulation::reset(const Reply& reply) {
  end_step_request(false, "ended by ~reset");
  world().reset();
  knows_contacts_ = true;
  failure_.clear();
  pacer_.restart(0.0);
  reply->set_value({true, with_warnings(paused_ ? "reset, paused" : "reset, running"), 0.0});
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
  const std::string answer =
      fmt::format("{} of {} steps made, at {:.6g} s{}{}", made, requested_steps_, world().time(),
                  message.empty() ? "" : "; ", message);
  step_reply_->set_value({success, success ? with_warnings(answer) : answer, world().time()});
  step_reply_ = nullptr;
}

void Simulation::drive_robot(std::size_t robot, std::unique_ptr<RobotDriver> driver) {
  scene_.robots[robot].driver = driver.get();
  world().add_driver(std::move(driver));
}

void Simulation::list_links(std::vector<PlacedFrame>& frames) const {
  for (std::size_t r = 0; r < scene_.robots.size(); ++r) {
    const SceneRobot& given = scene_.robots[r];
    const Robot& robot = *given.robot;
    for (const std::string& link : robot.link_names()) {
      if (is_placed_by_tf(robot, scene_.spec.robots[r], link)) continue;
      frames.push_back({link, given.link_pose(link)});
    }
  }
}

std::vector<PlacedFrame> Simulation::standing_roots() const {
  std::vector<PlacedFrame> roots;
  for (std::size_t r = 0; r < scene_.robots.size(); ++r) {
    if (!scene_.spec.robots[r].base_frame.empty()) continue;
    const std::string& root = scene_.robots[r].robot->link_names().front();
    roots.push_back({root, scene_.robots[r].link_pose(root)});
  }
  return roots;
}

bool Simulation::robot_is_ready() {
  if (!robots_ || robots_are_driven_) return true;
  if (Clock::now() < robots_deadline_ && !robots_->missing().empty()) return false;
  robots_->drive(scene_);
  robots_are_driven_ = true;
  pacer_.restart(world().time());
  return true;
}

std::optional<Simulation::Clock::time_point> Simulation::next_step() {
  const bool is_ready = robot_is_ready();
  refresh_warnings();
  if (!is_ready) return {};
  if (paused_ && !step_reply_) {
    senders_deadline_.reset();
    return {};
  }
  if (waits_for_senders()) return Clock::now() + kBetweenLooksForSenders;
  if (step_reply_) return Clock::time_point::min();
  return pacer_.due(world().time());
}

bool Simulation::waits_for_senders() {
  const double time = world().time();
  if (!publish_clock_ || !robots_ || !robots_->runs_ahead(time)) {
    senders_deadline_.reset();
    return false;
  }
  const Clock::time_point now = Clock::now();
  if (!senders_deadline_) senders_deadline_ = now + seconds(robots_->begin_waiting(time));
  if (now < *senders_deadline_) return true;
  robots_->stop_waiting(time);
  senders_deadline_.reset();
  return false;
}

double Simulation::seconds_between_observations() const {
  return kBetweenObservations * last_step_seconds_;
}

int Simulation::steps_at_once() {
  if (!step_reply_) return 1;
  const int wanted = std::min(steps_left_, kMostAtOnce);
  return world().resident_limit(wanted) >= 2 ? wanted : 1;
}

bool Simulation::make_step(const Seen& seen, const World::NextReadback& next_readback, bool alone) {
  Timer timer;
  std::uint64_t before = world().steps();
  const auto observe = [&](const World& now) {
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
    if (!world().advance(alone ? 1 : steps_at_once(), kBetweenObservations, observe,
                         next_readback)) {
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
