#include "pliant/scene/robot/motion/joint_loads.h"

#include <algorithm>
#include <cmath>

#include "pliant/scene/robot/robot_data.h"

namespace pliant {
namespace {

// Of the distance that contact keeps: how much nearer links may come to a body that has no room.
constexpr double kMostOverlap = 0.5, kCrushed = 0.8;
// Least share of a point's motion that is away from a body.
constexpr double kLeastShare = 0.2;

Eigen::Vector3d to_vector(const KDL::Vector& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

JointLoads::Motion JointLoads::motion(std::size_t link,
                                      const std::vector<Eigen::Isometry3d>& poses) const {
  const Robot::Data::Link& moved = robot_.data().links[link];
  const Eigen::Isometry3d& parent = poses[static_cast<std::size_t>(moved.parent)];
  const KDL::Joint& joint = moved.segment.getJoint();
  return {moved.multiplier * (parent.linear() * to_vector(joint.JointAxis())),
          parent * to_vector(joint.JointOrigin()), joint.getType() == KDL::Joint::TransAxis};
}

void JointLoads::add_forces(const std::vector<Eigen::Isometry3d>& poses) {
  const auto& links = robot_.data().links;
  // Parents come before their children.
  for (std::size_t k = links.size(); k-- > 0;) {
    if (links[k].parent < 0) continue;
    if (links[k].joint >= 0) {
      const Motion moves = motion(k, poses);
      const Eigen::Vector3d torque = torques_[k] - moves.origin.cross(forces_[k]);
      loads_[static_cast<std::size_t>(links[k].joint)].force +=
          moves.axis.dot(moves.is_prismatic ? forces_[k] : torque);
    }
    const auto parent = static_cast<std::size_t>(links[k].parent);
    forces_[parent] += forces_[k];
    torques_[parent] += torques_[k];
  }
}

void JointLoads::add_overlap(const Overlap& overlap, int link,
                             const std::vector<Eigen::Isometry3d>& poses) {
  const auto& links = robot_.data().links;
  // Of the joints that could make room, the one that is nearest to its limit does.
  int joint = -1;
  double worst = 0.0, away = 0.0;
  for (int k = link; k >= 0; k = links[static_cast<std::size_t>(k)].parent) {
    const int moved_by = links[static_cast<std::size_t>(k)].joint;
    if (moved_by < 0) continue;
    const double share =
        std::abs(loads_[static_cast<std::size_t>(moved_by)].force) / robot_.effort(moved_by);
    const Eigen::Vector3d velocity =
        motion(static_cast<std::size_t>(k), poses).velocity(overlap.at);
    const double speed = -velocity.dot(overlap.normal);
    if (share <= worst || std::abs(speed) < kLeastShare * velocity.norm()) continue;
    worst = share;
    joint = moved_by;
    away = std::abs(speed);
  }
  if (joint < 0) return;
  JointLoad& load = loads_[static_cast<std::size_t>(joint)];
  load.room = std::min(load.room, (kMostOverlap * overlap.offset - overlap.depth) / away);
  load.is_crushed = load.is_crushed || overlap.depth > kCrushed * overlap.offset;
}

const std::vector<JointLoad>& JointLoads::find(const std::vector<Eigen::Isometry3d>& poses,
                                               const std::vector<int>& link_of_obstacle,
                                               const std::vector<Obstacle>& obstacles,
                                               const std::vector<Reaction>& reactions) {
  loads_.assign(robot_.joint_names().size(), JointLoad());
  forces_.assign(poses.size(), Eigen::Vector3d::Zero());
  torques_.assign(poses.size(), Eigen::Vector3d::Zero());
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    if (link_of_obstacle[o] < 0) continue;
    const auto link = static_cast<std::size_t>(link_of_obstacle[o]);
    forces_[link] += reactions[o].force;
    torques_[link] +=
        reactions[o].torque + obstacles[o].pose_end.translation().cross(reactions[o].force);
  }
  add_forces(poses);
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    if (link_of_obstacle[o] < 0 || !(reactions[o].overlap.depth > 0.0)) continue;
    add_overlap(reactions[o].overlap, link_of_obstacle[o], poses);
  }
  return loads_;
}

}  // namespace pliant
