#include "pliant/ros/interactive/hand_control.h"

#include <fmt/format.h>

namespace pliant {

HandControl::HandControl(std::shared_ptr<const Robot> robot, const std::string& link,
                         InverseKinematics kinematics)
    : robot_(std::move(robot)), link_(link), kinematics_(std::move(kinematics)) {}

std::unique_ptr<HandControl> HandControl::make(std::shared_ptr<const Robot> robot,
                                               std::shared_ptr<JointSource> usual,
                                               const std::string& link, const World& world) {
  const std::string hand = link.empty() ? find_hand(*robot) : link;
  if (hand.empty()) return nullptr;
  InverseKinematics kinematics(*robot, hand);
  const std::vector<int> arm = kinematics.joints();
  std::unique_ptr<HandControl> control(new HandControl(robot, hand, std::move(kinematics)));
  // With fewer joints a hand has no orientation of its own at each place.
  control->can_turn_ = arm.size() >= 6;
  control->hand_ =
      std::make_shared<RobotHand>(robot, std::move(usual), find_fingers(*robot, hand, arm), world);
  return control;
}

std::shared_ptr<JointSource> HandControl::source() {
  is_driving_ = true;
  return hand_;
}

Answer HandControl::command(SimulationThread& simulation,
                            const std::function<std::string(RobotHand&)>& command) {
  return simulation.ask([&](Simulation& now) {
    if (!is_driving_) now.drive_robot(std::make_unique<RobotDriver>(robot_, hand_));
    is_driving_ = true;
    const std::string what = command(*hand_);
    return Answer{true, what, now.world().time()};
  });
}

double HandControl::reach() const {
  return kinematics_.pose(robot_->initial_positions()).translation().norm();
}

Eigen::Isometry3d HandControl::pose(SimulationThread& simulation) const {
  std::vector<double> present;
  simulation.ask([&](Simulation&) {
    present = hand_->present();
    return Answer{true, "", 0.0};
  });
  return present.empty() ? Eigen::Isometry3d::Identity() : robot_->link_pose(link_, present);
}

Answer HandControl::move_to(const Eigen::Isometry3d& world_from_hand,
                            SimulationThread& simulation) {
  std::vector<double> present, goal;
  simulation.ask([&](Simulation&) {
    present = hand_->present();
    goal = hand_->is_taken() ? hand_->goal() : present;
    return Answer{true, "", 0.0};
  });
  if (present.empty()) return {};
  const Eigen::Isometry3d world_from_root =
      robot_->link_pose(robot_->link_names().front(), present);
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
