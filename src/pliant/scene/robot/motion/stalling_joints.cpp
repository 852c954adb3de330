#include "pliant/scene/robot/motion/stalling_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pliant {
namespace {

// Of the effort: a load above that is one that the next step cannot mend.
constexpr double kTooMuch = 1.1;
// Of a room: what links may take of it in a step.
constexpr double kShareOfRoom = 0.5;
// With what a joint without a speed of its own catches up [m/s] or [rad/s].
constexpr double kCatchUp = 0.5;
// A joint that stalled picks up speed from step to step, from this share of its velocity: a body
// that turns or slides between links leaves them for single steps.
constexpr double kPicksUp = 2.0, kSlowest = 1.0 / 64.0;
// What is so near is the same place [m] or [rad].
constexpr double kThere = 1e-12;
// Of the effort: a load below that is one that is looked for nearer to it in a step that found too
// much, and what a step with such a load leaves of what is known of a stiffness.
constexpr double kTooLittle = 0.5, kForgets = 0.7;
// Of the effort: a load that has set in, and one that is none.
constexpr double kPresses = 0.3, kNothing = 0.05;

double sign(double value) { return value < 0.0 ? -1.0 : 1.0; }

}  // namespace

StallingJoints::StallingJoints(const Robot& robot) : robot_(robot) {
  for (int j = 0; j < static_cast<int>(robot.joint_names().size()); ++j) {
    if (!std::isfinite(robot.effort(j))) continue;
    Joint joint;
    joint.index = j;
    joint.effort = robot.effort(j);
    const double velocity = robot.limits(j).velocity;
    joint.velocity = std::isfinite(velocity) ? velocity : kCatchUp;
    limited_.push_back(joint);
  }
}

StallingJoints::Joint StallingJoints::fresh(const Joint& joint) {
  Joint fresh;
  fresh.index = joint.index;
  fresh.effort = joint.effort;
  fresh.velocity = joint.velocity;
  fresh.is_noted = joint.is_noted;
  return fresh;
}

void StallingJoints::reset() {
  for (Joint& joint : limited_) joint = fresh(joint);
}

double StallingJoints::slowest(const Joint& joint, double duration) {
  const double slowest = kSlowest * joint.velocity;
  if (!(joint.stiffness > 0.0)) return slowest;
  return std::min(slowest, joint.effort / (joint.stiffness * duration));
}

double StallingJoints::step(const Joint& joint, double duration) {
  const double want = joint.told - joint.start;
  double most = std::min(std::abs(want), joint.speed * duration);
  const double opposing = -sign(want) * joint.load.force;
  if (opposing > 0.0) {
    const double left = joint.effort - opposing;
    // Where little is known of what presses, it goes back no further than it could in that time.
    const double back = joint.velocity * duration;
    if (joint.stiffness > 0.0) most = std::min(most, std::max(left / joint.stiffness, -back));
    if (std::isfinite(joint.load.room)) {
      const double room = joint.load.room;
      most = std::min(most, room > 0.0 ? kShareOfRoom * room : room);
    }
  }
  return sign(want) * most;
}

bool StallingJoints::has_lost(const Joint& joint) {
  if (!joint.pressing || std::isfinite(joint.load.room)) return false;
  const double back = sign(joint.told - joint.start) * (*joint.pressing - joint.start);
  return back > kThere && std::abs(joint.load.force) < kTooLittle * joint.effort;
}

double StallingJoints::return_to_body(const Joint& joint, double duration) {
  const double most = std::min(std::abs(joint.told - joint.start), joint.velocity * duration);
  return std::clamp(*joint.pressing - joint.start, -most, most);
}

void StallingJoints::advance(const std::vector<double>& told, double duration,
                             std::vector<double>& positions) {
  for (Joint& joint : limited_) joint.start = positions[static_cast<std::size_t>(joint.index)];
  positions = told;
  duration_ = duration;
  for (Joint& joint : limited_) {
    const auto j = static_cast<std::size_t>(joint.index);
    joint.told = told[j];
    joint.tried = {joint.start, joint.load.force};
    joint.is_tried = false;
    joint.over.reset();
    joint.under.reset();
    joint.after = 0.0;
    joint.pressed = std::abs(joint.load.force) >= kTooLittle * joint.effort;
    joint.probe = kSlowest * joint.velocity * duration;
    if (std::abs(joint.load.force) < joint.effort) {
      joint.under = joint.tried;
      if (std::abs(joint.load.force) < kTooLittle * joint.effort) joint.stiffness *= kForgets;
    }
    if (!joint.lags || !(duration > 0.0)) continue;
    joint.speed =
        std::min(joint.velocity, std::max(kPicksUp * joint.speed, slowest(joint, duration)));
    const double change = has_lost(joint) ? return_to_body(joint, duration) : step(joint, duration);
    joint.speed = std::min(joint.speed, std::abs(change) / duration);
    positions[j] = joint.start + change;
    joint.lags = std::abs(positions[j] - joint.told) > kThere;
    if (!joint.lags) positions[j] = joint.told;
  }
}

void StallingJoints::learn(Joint& joint, const Try& to) {
  const Try from = joint.tried;
  const bool is_same_step = std::exchange(joint.is_tried, true);
  const double slope = -(to.force - from.force) / (to.position - from.position);
  if (std::abs(to.position - from.position) < kThere || !(slope > 0.0)) return;
  // What presses grows where the joint goes against it. From where hardly anything presses, the
  // way there tells too little: what is pressed is at least as stiff as that.
  const bool presses = std::abs(from.force) > kPresses * joint.effort &&
                       std::abs(to.force) > kPresses * joint.effort;
  const bool is_stiffer = is_same_step && slope > joint.stiffness;
  if (presses || is_stiffer || joint.stiffness == 0.0) joint.stiffness = slope;
}

bool StallingJoints::find_place(Joint& joint, const Try& tried, double& position) {
  const double load = std::abs(tried.force);
  if (load > kTooMuch * joint.effort) {
    joint.over = tried;
  } else if (joint.over && load < kTooLittle * joint.effort) {
    joint.under = tried;
  } else {
    return false;
  }
  const Try& over = *joint.over;
  double back = (std::abs(over.force) - joint.effort) / joint.stiffness;
  if (joint.stiffness == 0.0) {
    back = joint.probe;
    joint.probe *= kPicksUp;
  }
  position = over.position + sign(over.force) * back;
  if (!joint.under) return true;
  // A load that sets in on the way there is not linear in it.
  const double way = sign(over.force) * (joint.under->position - over.position);
  if (way > kThere && back >= way) position = 0.5 * (joint.under->position + over.position);
  return position != tried.position;
}

bool StallingJoints::has_slipped_away(const Joint& joint, const Try& tried) {
  return joint.lags && joint.pressed && !joint.over && !std::isfinite(joint.load.room) &&
         std::abs(tried.force) < kNothing * joint.effort;
}

double StallingJoints::go_after(Joint& joint, const Try& tried, double duration) {
  joint.under = tried;
  const double most = joint.velocity * duration;
  double further = std::min(joint.probe, most);
  if (joint.stiffness > 0.0) further = std::min(further, joint.effort / joint.stiffness);
  joint.after = joint.after > 0.0 ? kPicksUp * joint.after : further;
  const double way = joint.told - joint.start;
  const double gone = std::abs(tried.position - joint.start) + joint.after;
  return joint.start + sign(way) * std::min({gone, std::abs(way), most});
}

bool StallingJoints::go_back(Joint& joint, const JointLoad& load, double& position) const {
  const Try tried{position, load.force};
  if (has_slipped_away(joint, tried)) {
    position = go_after(joint, tried, duration_);
  } else if (!find_place(joint, tried, position)) {
    position = tried.position;
  }
  if (load.is_crushed) {
    const double away = tried.position - sign(load.force) * load.room;
    if (sign(load.force) * (away - position) > 0.0) position = away;
  }
  // Stops at the ends of its way hold whatever presses.
  const Robot::Limits limits = robot_.limits(joint.index);
  position =
      std::clamp(position, std::min(limits.lower, joint.told), std::max(limits.upper, joint.told));
  if (std::abs(position - tried.position) < kThere) return false;
  joint.lags = true;
  joint.speed = 0.0;
  return true;
}

bool StallingJoints::answer(const std::vector<JointLoad>& loads, bool last,
                            std::vector<double>& positions) {
  bool any = false;
  for (Joint& joint : limited_) {
    const auto j = static_cast<std::size_t>(joint.index);
    const Try tried{positions[j], loads[j].force};
    learn(joint, tried);
    joint.tried = tried;
    joint.load = loads[j];
    const bool presses = std::abs(tried.force) >= kTooLittle * joint.effort;
    if (presses || std::isfinite(loads[j].room)) joint.pressing = tried.position;
    if (!last && go_back(joint, loads[j], positions[j])) any = true;
  }
  return any;
}

bool StallingJoints::hold_back(std::vector<double>& positions) {
  bool any = false;
  for (Joint& joint : limited_) {
    double& position = positions[static_cast<std::size_t>(joint.index)];
    if (position == joint.start) continue;
    position = joint.start;
    joint.lags = any = true;
    joint.speed = 0.0;
  }
  return any;
}

void StallingJoints::save(StateArchive& numbers) const {
  for (const Joint& joint : limited_) {
    numbers.write(joint.lags ? 1.0 : 0.0);
    numbers.write(joint.speed);
    numbers.write(joint.stiffness);
    numbers.write(joint.pressing.value_or(std::numeric_limits<double>::quiet_NaN()));
    numbers.write(joint.load.force);
    numbers.write(joint.load.room);
  }
}

void StallingJoints::load(StateArchive& numbers) {
  for (Joint& joint : limited_) {
    joint.lags = numbers.read() == 1.0;
    joint.speed = numbers.read();
    joint.stiffness = numbers.read();
    const double pressing = numbers.read();
    joint.pressing.reset();
    if (std::isfinite(pressing)) joint.pressing = pressing;
    joint.load.force = numbers.read();
    joint.load.room = numbers.read();
    // A damaged state, or one from before the robot was limited.
    const bool is_whole = joint.speed >= 0.0 && joint.speed <= joint.velocity &&
                          joint.stiffness >= 0.0 && std::isfinite(joint.stiffness) &&
                          std::isfinite(joint.load.force) && !std::isnan(joint.load.room);
    if (!is_whole) joint = fresh(joint);
  }
}

std::string StallingJoints::note(const Joint& joint) const {
  const bool has_room = std::isinf(joint.load.room);
  return fmt::format("joint_stalled: joint '{}' stays behind what it is told: {}",
                     robot_.joint_names()[static_cast<std::size_t>(joint.index)],
                     has_room
                         ? fmt::format("bodies press with its effort of {:g} {}", joint.effort,
                                       robot_.unit(joint.index) == std::string("m") ? "N" : "N m")
                         : std::string("what is between links leaves them no room"));
}

void StallingJoints::note_first(std::vector<std::string>& notes) {
  for (Joint& joint : limited_) {
    if (!joint.lags || joint.is_noted) continue;
    joint.is_noted = true;
    notes.push_back(note(joint));
  }
}

void StallingJoints::note_present(std::vector<std::string>& notes) const {
  for (const Joint& joint : limited_) {
    if (joint.lags) notes.push_back(note(joint));
  }
}

}  // namespace pliant
