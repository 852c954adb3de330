#include "pliant/scene/robot/robot_tree.h"

#include <algorithm>
#include <cmath>

#include "pliant/scene/robot/robot_data.h"

namespace pliant {
namespace {

using Link = Robot::Data::Link;

const Link& link_at(const Robot& robot, int link) {
  return robot.data().links[static_cast<std::size_t>(link)];
}

/// Of each link, whether the joint above it or one below it moves.
std::vector<bool> branches_that_move(const Robot& robot) {
  const std::vector<Link>& links = robot.data().links;
  std::vector<bool> moves(links.size(), false);
  for (std::size_t l = links.size(); l-- > 1;) {  // parents come first
    moves[l] = moves[l] || links[l].joint >= 0;
    if (moves[l] && links[l].parent >= 0) moves[static_cast<std::size_t>(links[l].parent)] = true;
  }
  return moves;
}

/// Whether `link` is `ancestor` or hangs on it.
bool hangs_on(const Robot& robot, int link, int ancestor) {
  while (link >= 0 && link != ancestor) link = link_at(robot, link).parent;
  return link == ancestor;
}

/// How far apart the links are that hang on the hand: the sum of the distances of the middles of
/// their shapes, of their frames where they have none, from their mean [m].
double spread(const Robot& robot, int hand, const std::vector<double>& positions) {
  std::vector<Eigen::Isometry3d> poses;
  robot.link_poses(positions, poses);
  const Robot::Data& data = robot.data();
  std::vector<Eigen::Vector3d> points;
  for (int l = 0; l < static_cast<int>(data.links.size()); ++l) {
    if (l == hand || !hangs_on(robot, l, hand)) continue;
    const Eigen::Isometry3d& pose = poses[static_cast<std::size_t>(l)];
    points.push_back(pose.translation());
    for (const Robot::Data::Collision& shape : data.collisions) {
      if (shape.link == l) points.push_back(pose * shape.link_from_shape.translation());
    }
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) mean += point / static_cast<double>(points.size());
  double sum = 0.0;
  for (const Eigen::Vector3d& point : points) sum += (point - mean).norm();
  return sum;
}

}  // namespace

std::string find_hand(const Robot& robot) {
  const std::vector<Link>& links = robot.data().links;
  const std::vector<bool> moves = branches_that_move(robot);
  int hand = 0;
  bool is_moved = false;
  while (true) {
    std::vector<int> branches;
    for (int l = 1; l < static_cast<int>(links.size()); ++l) {
      const bool is_child = links[static_cast<std::size_t>(l)].parent == hand;
      if (is_child && moves[static_cast<std::size_t>(l)]) branches.push_back(l);
    }
    if (branches.size() != 1) break;
    hand = branches.front();
    is_moved = is_moved || link_at(robot, hand).joint >= 0;
  }
  return is_moved ? robot.link_names()[static_cast<std::size_t>(hand)] : "";
}

std::vector<FingerJoint> find_fingers(const Robot& robot, const std::string& hand,
                                      const std::vector<int>& arm) {
  // Fingers hang on the last link that all of them share, which a tool frame need not be.
  const std::string palm_name = find_hand(robot);
  const int palm = robot.link_index(palm_name.empty() ? hand : palm_name).value_or(0);
  std::vector<FingerJoint> fingers;
  for (int j = 0; j < static_cast<int>(robot.joint_names().size()); ++j) {
    const Robot::Limits limits = robot.limits(j);
    const bool is_of_arm = std::count(arm.begin(), arm.end(), j) > 0;
    if (is_of_arm || !std::isfinite(limits.lower) || !std::isfinite(limits.upper)) continue;
    std::vector<double> low = robot.initial_positions(), high = low;
    low[static_cast<std::size_t>(j)] = limits.lower;
    high[static_cast<std::size_t>(j)] = limits.upper;
    const bool high_is_open = spread(robot, palm, high) >= spread(robot, palm, low);
    fingers.push_back({j, high_is_open ? limits.upper : limits.lower,
                       high_is_open ? limits.lower : limits.upper});
  }
  return fingers;
}

std::vector<std::string> links_moved_by(const Robot& robot, int joint) {
  std::vector<std::string> names;
  for (int l = 0; l < static_cast<int>(robot.link_names().size()); ++l) {
    for (int up = l; up >= 0; up = link_at(robot, up).parent) {
      if (link_at(robot, up).joint != joint) continue;
      names.push_back(robot.link_names()[static_cast<std::size_t>(l)]);
      break;
    }
  }
  return names;
}

}  // namespace pliant
