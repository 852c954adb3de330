#include "pliant/ros/robot/robot_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <ros/console.h>

#include <algorithm>

#include "pliant/math/error.h"

namespace pliant {
namespace {

// Publishers of a robot's parts may start one after the other.
constexpr auto kUntoldPatience = std::chrono::seconds(5);
constexpr std::size_t kMostUnknown = 10;
constexpr std::size_t kMostNames = 100'000;

}  // namespace

RobotInput::RobotInput(const LoadedScene& scene, bool use_joint_states, bool stamps_are_simulated,
                       const FrameTransformer& frames)
    : uses_joint_states_(use_joint_states && !scene.robots.empty()),
      last_warning_(Clock::now() - std::chrono::hours(1)) {
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const SceneRobot& given = scene.robots[r];
    Moved moved;
    moved.robot = given.robot;
    if (use_joint_states) {
      moved.joint_states = std::make_shared<JointStateSource>(given.robot, stamps_are_simulated);
    }
    moved.keyframes = given.keyframes;
    moved.placement = std::make_shared<TfPlacementSource>(
        *given.robot, scene.spec.robots[r].base_frame, stamps_are_simulated, frames);
    if (moved.placement->empty()) moved.placement = nullptr;
    robots_.push_back(std::move(moved));
  }
}

void RobotInput::on_message(const sensor_msgs::JointStateConstPtr& message) {
  try {
    for (const Moved& moved : robots_) moved.joint_states->set(*message);
    note_names(message->name);
  } catch (const std::exception& error) {
    // Not ROS_WARN_THROTTLE, which is silent while ROS time stands still at 0.
    const auto now = Clock::now();
    if (now - last_warning_ < std::chrono::seconds(5)) return;
    last_warning_ = now;
    ROS_WARN("joint_states: message refused, the robot stays where it is: %s", error.what());
  }
}

void RobotInput::note_names(const std::vector<std::string>& names) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!received_) first_message_ = Clock::now();
  received_ = true;
  for (const std::string& name : names) {
    if (names_.count(name) > 0 || names_.size() >= kMostNames) continue;
    names_.insert(name);
    const std::string note = unknown_joint(name);
    if (!note.empty() && unknown_.size() < kMostUnknown) unknown_.push_back(note);
  }
}

/// Empty for a joint that a robot has.
std::string RobotInput::unknown_joint(const std::string& joint) const {
  std::vector<std::string> known;
  for (const Moved& moved : robots_) {
    const Robot& robot = *moved.robot;
    if (robot.joint_index(joint) || !robot.why_no_position(joint).empty()) return "";
    known.insert(known.end(), robot.joint_names().begin(), robot.joint_names().end());
  }
  const std::string nearest = nearest_name(joint, known);
  return fmt::format(
      "unknown_joint: joint_states names joint '{}', which no robot of the scene "
      "has: it is left out{}",
      joint, nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
}

std::vector<std::string> RobotInput::missing() const {
  std::vector<std::string> texts;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (uses_joint_states_ && !received_) {
      texts.emplace_back("joint_states: no message has come");
    }
  }
  for (const Moved& moved : robots_) {
    if (!moved.placement) continue;
    for (const std::string& text : moved.placement->missing()) {
      texts.push_back("robot '" + moved.robot->name() + "': " + text);
    }
  }
  return texts;
}

void RobotInput::drive(LoadedScene& scene) {
  for (std::size_t r = 0; r < robots_.size(); ++r) {
    Moved& moved = robots_[r];
    std::shared_ptr<JointSource> joints = moved.keyframes;
    if (moved.joint_states) joints = moved.joint_states;
    if (!joints && !moved.placement) continue;
    auto driver = std::make_unique<RobotDriver>(moved.robot, joints, moved.placement);
    // Keyframes were looked at when the scene was loaded.
    if (moved.joint_states) driver->watch();
    scene.robots[r].driver = moved.driver = driver.get();
    scene.world->add_driver(std::move(driver));
  }
}

bool RobotInput::runs_ahead(double time) const {
  return std::any_of(robots_.begin(), robots_.end(), [&](const Moved& moved) {
    return (moved.joint_states && moved.joint_states->runs_ahead(time)) ||
           (moved.placement && moved.placement->runs_ahead(time));
  });
}

double RobotInput::begin_waiting(double time) {
  double patience = 0.0;
  for (const Moved& moved : robots_) {
    if (moved.joint_states && moved.joint_states->runs_ahead(time)) {
      patience = std::max(patience, moved.joint_states->begin_waiting());
    }
    if (moved.placement) patience = std::max(patience, moved.placement->begin_waiting(time));
  }
  return patience;
}

void RobotInput::stop_waiting(double time) {
  for (const Moved& moved : robots_) {
    if (moved.joint_states && moved.joint_states->runs_ahead(time)) {
      moved.joint_states->stop_waiting();
    }
    if (moved.placement) moved.placement->stop_waiting(time);
  }
}

/// Empty where nothing has.
std::string RobotInput::stopped(const Moved& moved) {
  std::string last;
  if (moved.joint_states && moved.joint_states->lag().has_stopped()) {
    last = fmt::format("the newest of joint_states is stamped {:.6g} s",
                       moved.joint_states->lag().newest());
  } else if (moved.placement) {
    last = moved.placement->stopped();
  }
  if (last.empty()) return "";
  return fmt::format(
      "sender_stopped: {}; the simulation waited {:g} s of wall time for more and goes on "
      "without: robot '{}' stays where it was last told to be; look whether its sender still runs",
      last, SenderLag::kPatience, moved.robot->name());
}

void RobotInput::add_untold(std::vector<std::string>& notes) const {
  if (!received_ || Clock::now() - first_message_ < kUntoldPatience) return;
  std::vector<std::string> untold;
  for (const Moved& moved : robots_) {
    const Robot& robot = *moved.robot;
    for (const std::string& joint : robot.joint_names()) {
      if (names_.count(joint) > 0) continue;
      std::string hint;
      for (const auto& [mimic, followed] : robot.mimics()) {
        if (followed == joint && names_.count(mimic) > 0) {
          hint = " (only '" + mimic + "', which mimics it)";
        }
      }
      untold.push_back("'" + joint + "'" + hint);
    }
  }
  if (untold.empty()) return;
  notes.push_back(fmt::format(
      "missing_joint: no message of joint_states named {}: {} where the "
      "robot started",
      fmt::join(untold, ", "), untold.size() == 1 ? "this joint stays" : "these joints stay"));
}

std::vector<std::string> RobotInput::told() const {
  std::vector<std::string> told;
  for (const Moved& moved : robots_) {
    if (moved.driver == nullptr) continue;
    told.insert(told.end(), moved.driver->notes().begin(), moved.driver->notes().end());
  }
  return told;
}

std::vector<std::string> RobotInput::notes() const {
  std::vector<std::string> notes;
  bool is_driven = false;
  for (const Moved& moved : robots_) {
    if (moved.driver == nullptr) continue;
    is_driven = true;
    const std::vector<std::string> own = moved.driver->present_notes();
    notes.insert(notes.end(), own.begin(), own.end());
    const auto add_once = [&](const std::string& note) {
      if (note.empty() || std::find(notes.begin(), notes.end(), note) != notes.end()) return;
      notes.push_back(note);
    };
    if (moved.joint_states) add_once(moved.joint_states->note());
    if (moved.placement) add_once(moved.placement->note());
    add_once(stopped(moved));
  }
  if (is_driven) {
    for (const std::string& text : missing()) {
      notes.push_back("robot_input: " + text + ": the robot stays where it started");
    }
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  notes.insert(notes.end(), unknown_.begin(), unknown_.end());
  if (uses_joint_states_) add_untold(notes);
  return notes;
}

}  // namespace pliant
