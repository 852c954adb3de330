#include "pliant/ros/interactive/hand_control.h"

#include <fmt/format.h>

#include <map>
#include <sstream>

#include "pliant/math/error.h"

namespace pliant {

HandControl::HandControl(const LoadedScene& scene, std::size_t robot, const std::string& link,
                         InverseKinematics kinematics)
    : index_(robot),
      robot_(scene.robots[robot].robot),
      name_(scene.spec.robots[robot].prefix + "hand"),
      link_(link),
      kinematics_(std::move(kinematics)) {}

std::unique_ptr<HandControl> HandControl::make(LoadedScene& scene, std::size_t index,
                                               const std::string& link) {
  SceneRobot& given = scene.robots[index];
  const Robot& robot = *given.robot;
  const std::string hand = link.empty() ? find_hand(robot) : link;
  if (hand.empty()) return nullptr;
  InverseKinematics kinematics(robot, hand);
  const std::vector<int> arm = kinematics.joints();
  std::unique_ptr<HandControl> control(new HandControl(scene, index, hand, std::move(kinematics)));
  // With fewer joints a hand has no orientation of its own at each place.
  control->can_turn_ = arm.size() >= 6;
  control->hand_ = std::make_shared<RobotHand>(given.robot, given.keyframes,
                                               find_fingers(robot, hand, arm), *scene.world);
  // What follows tf has a driver in any case.
  control->is_driving_ = given.keyframes != nullptr || !robot.free_joints().empty() ||
                         !scene.spec.robots[index].base_frame.empty();
  if (control->is_driving_) given.keyframes = control->hand_;
  return control;
}

namespace {

/// The link named for each robot; "": none.
std::vector<std::string> links_of_robots(const LoadedScene& scene, const std::string& links) {
  std::vector<std::string> chosen(scene.robots.size()), known;
  for (const SceneRobot& given : scene.robots) {
    const std::vector<std::string>& own = given.robot->link_names();
    known.insert(known.end(), own.begin(), own.end());
  }
  std::string link;
  for (std::istringstream list(links); std::getline(list >> std::ws, link, ',');) {
    link.erase(link.find_last_not_of(" \t") + 1);
    std::size_t r = 0;
    while (r < scene.robots.size() && !scene.robots[r].robot->link_index(link)) ++r;
    if (r == scene.robots.size()) {
      throw InputError("~hand_link: " + unknown_name_message("robot link", link, known));
    }
    if (!chosen[r].empty()) {
      throw InputError(
          fmt::format("~hand_link names two links of one robot, '{}' and '{}': name "
                      "one a robot",
                      chosen[r], link));
    }
    chosen[r] = link;
  }
  return chosen;
}

}  // namespace

Hands make_hands(LoadedScene& scene, const std::string& links) {
  Hands made;
  const std::vector<std::string> chosen = links_of_robots(scene, links);
  std::map<std::string, int> names;
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    auto hand = HandControl::make(scene, r, chosen[r]);
    if (!hand) {
      made.why_not.push_back(fmt::format(
          "the links of robot '{}' branch where none is moved by a joint, so that no hand was "
          "found: name one by hand_link to drag it",
          scene.spec.robots[r].prefix + scene.robots[r].robot->name()));
      continue;
    }
    const int number = ++names[hand->name()];
    if (number > 1) hand->call(fmt::format("{}_{}", hand->name(), number));
    made.hands.push_back(std::move(hand));
  }
  return made;
}

Answer HandControl::command(SimulationThread& simulation,
                            const std::function<std::string(RobotHand&)>& command) {
  return simulation.ask([&](Simulation& now) {
    if (!is_driving_) now.drive_robot(index_, std::make_unique<RobotDriver>(robot_, hand_));
    is_driving_ = true;
    const std::string what = command(*hand_);
    return Answer{true, what, now.world().time()};
  });
}

double HandControl::reach() const {
  return kinematics_.pose(robot_->initial_positions()).translation().norm();
}

Eigen::Isometry3d HandControl::pose(SimulationThread& simulation) const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  simulation.ask([&](Simulation& now) {
    pose = now.link_pose(link_);
    return Answer{true, "", 0.0};
  });
  return pose;
}

Answer HandControl::move_to(const Eigen::Isometry3d& world_from_hand,
                            SimulationThread& simulation) {
  std::vector<double> present, goal;
  Eigen::Isometry3d world_from_root;
  simulation.ask([&](Simulation& now) {
    world_from_root = now.link_pose(robot_->link_names().front());
    present = hand_->present();
    goal = hand_->is_taken() ? hand_->goal() : present;
    return Answer{true, "", 0.0};
  });
  if (present.empty()) return {};
  const Eigen::Isometry3d root_from_hand = world_from_root.inverse() * world_from_hand;
  // Close to the last goal the same way of holding the arm goes on.
  InverseKinematics::Solution solution = kinematics_.step(root_from_hand, goal);
  if (!solution.reached) solution = kinematics_.solve(root_from_hand, present);
  return command(simulation, [&](RobotHand& hand) {
    hand.move_to(solution.positions);
    const std::string how_near =
        solution.reached ? ""
                         : fmt::format(", but reaches only to {:.3g} m and {:.2g} rad from it",
                                       solution.distance, solution.angle);
    return fmt::format("'{}' goes to the marker{}", link_, how_near);
  });
}

}  // namespace pliant
