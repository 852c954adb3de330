#include "pliant/scene/inverse_kinematics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_nr_jl.hpp>
#include <kdl/chainiksolvervel_wdls.hpp>
#include <limits>

#include "pliant/math/error.h"
#include "pliant/scene/robot_data.h"

namespace pliant {
namespace {

constexpr unsigned int kIterations = 300;
constexpr int kWaypoints = 50;
// Singular values of the Jacobian below kNearSingular are damped, so that the arm neither jumps
// near a singular configuration nor fails when it is asked for more than it reaches.
constexpr double kNearSingular = 0.05;
constexpr double kDamping = 0.1;
constexpr double kAngleWeight = 0.2;  // metres of distance that count as much as a radian

KDL::Frame to_frame(const Eigen::Isometry3d& pose) {
  KDL::Frame frame;
  for (int i = 0; i < 3; ++i) {
    frame.p[i] = pose.translation()[i];
    for (int j = 0; j < 3; ++j) frame.M(i, j) = pose.linear()(i, j);
  }
  return frame;
}

Eigen::Isometry3d to_pose(const KDL::Frame& frame) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) {
    pose.translation()[i] = frame.p[i];
    for (int j = 0; j < 3; ++j) pose.linear()(i, j) = frame.M(i, j);
  }
  return pose;
}

}  // namespace

struct InverseKinematics::Chain {
  std::vector<int> joints;
  KDL::Chain chain;
  KDL::JntArray lower, upper;
  std::unique_ptr<KDL::ChainFkSolverPos_recursive> forward;
  std::unique_ptr<KDL::ChainIkSolverVel_wdls> velocity;
  std::unique_ptr<KDL::ChainIkSolverPos_NR_JL> position;

  void add_segments(const Robot::Data& robot, int link);
  void make_solvers(const Robot::Data& robot);

  KDL::JntArray of_chain(const std::vector<double>& positions) const {
    KDL::JntArray array(chain.getNrOfJoints());
    for (unsigned int j = 0; j < array.rows(); ++j) {
      array(j) = positions.at(static_cast<std::size_t>(joints[j]));
    }
    return array;
  }

  void fill(const KDL::JntArray& array, Solution& solution) const {
    for (unsigned int j = 0; j < array.rows(); ++j) {
      solution.positions[static_cast<std::size_t>(joints[j])] = array(j);
    }
  }
};

void InverseKinematics::Chain::add_segments(const Robot::Data& robot, int link) {
  std::vector<int> links;
  for (int l = link; robot.links[static_cast<std::size_t>(l)].parent >= 0;
       l = robot.links[static_cast<std::size_t>(l)].parent) {
    links.push_back(l);
  }
  std::reverse(links.begin(), links.end());
  const std::string& name = robot.link_names[static_cast<std::size_t>(link)];
  for (const int l : links) {
    const Robot::Data::Link& part = robot.links[static_cast<std::size_t>(l)];
    const KDL::Joint& joint = part.segment.getJoint();
    chain.addSegment(part.segment);
    if (joint.getType() == KDL::Joint::None) continue;
    if (robot.passive_joints.count(joint.getName()) > 0) {
      throw InputError(fmt::format(
          "link '{}' is moved by joint '{}', which mimics another one: give joint positions, or "
          "the pose of a link that no mimicking joint moves",
          name, joint.getName()));
    }
    joints.push_back(part.joint);
  }
  if (joints.empty()) {
    throw InputError(fmt::format("no joint moves link '{}' against the root link '{}'", name,
                                 robot.link_names.front()));
  }
}

void InverseKinematics::Chain::make_solvers(const Robot::Data& robot) {
  lower.resize(chain.getNrOfJoints());
  upper.resize(chain.getNrOfJoints());
  for (unsigned int j = 0; j < chain.getNrOfJoints(); ++j) {
    const Robot::Limits& limits = robot.limits[static_cast<std::size_t>(joints[j])];
    lower(j) = limits.lower;
    upper(j) = limits.upper;
  }
  forward = std::make_unique<KDL::ChainFkSolverPos_recursive>(chain);
  velocity = std::make_unique<KDL::ChainIkSolverVel_wdls>(chain);
  velocity->setEps(kNearSingular);
  velocity->setLambda(kDamping);
  position = std::make_unique<KDL::ChainIkSolverPos_NR_JL>(chain, lower, upper, *forward, *velocity,
                                                           kIterations, kTolerance);
}

InverseKinematics::InverseKinematics(const Robot& robot, const std::string& link)
    : chain_(std::make_unique<Chain>()) {
  const std::optional<int> index = robot.link_index(link);
  if (!index) throw InputError(unknown_name_message("link", link, robot.link_names()));
  const std::lock_guard<std::mutex> lock(robot.data().segments_in_use);
  chain_->add_segments(robot.data(), *index);
  chain_->make_solvers(robot.data());
}

InverseKinematics::InverseKinematics(InverseKinematics&&) noexcept = default;
InverseKinematics::~InverseKinematics() = default;

const std::vector<int>& InverseKinematics::joints() const { return chain_->joints; }

Eigen::Isometry3d InverseKinematics::pose(const std::vector<double>& positions) const {
  KDL::Frame frame;
  chain_->forward->JntToCart(chain_->of_chain(positions), frame);
  return to_pose(frame);
}

InverseKinematics::Solution InverseKinematics::step(const Eigen::Isometry3d& root_from_link,
                                                    const std::vector<double>& start) const {
  Solution solution;
  solution.positions = start;
  KDL::JntArray found(chain_->chain.getNrOfJoints());
  const int result =
      chain_->position->CartToJnt(chain_->of_chain(start), to_frame(root_from_link), found);
  if (found.data.allFinite()) chain_->fill(found, solution);
  const Eigen::Isometry3d error = pose(solution.positions).inverse() * root_from_link;
  solution.distance = error.translation().norm();
  solution.angle = Eigen::AngleAxisd(error.rotation()).angle();
  solution.reached = result == KDL::SolverI::E_NOERROR;
  return solution;
}

InverseKinematics::Solution InverseKinematics::solve(const Eigen::Isometry3d& root_from_link,
                                                     const std::vector<double>& start) const {
  const auto error = [](const Solution& s) { return s.distance + kAngleWeight * s.angle; };
  Solution best = step(root_from_link, start);
  if (best.reached) return best;
  // Far away, Newton's iterations run into the limits: many short ways instead of a long one.
  Solution on_the_way{start};
  const Eigen::Isometry3d from = pose(start);
  const Eigen::Quaterniond turn(from.linear()), end_turn(root_from_link.linear());
  for (int k = 1; k <= kWaypoints; ++k) {
    const double share = static_cast<double>(k) / kWaypoints;
    Eigen::Isometry3d waypoint = Eigen::Isometry3d::Identity();
    waypoint.translation() =
        from.translation() + share * (root_from_link.translation() - from.translation());
    waypoint.linear() = turn.slerp(share, end_turn).toRotationMatrix();
    on_the_way = step(k == kWaypoints ? root_from_link : waypoint, on_the_way.positions);
  }
  return error(on_the_way) < error(best) ? on_the_way : best;
}

}  // namespace pliant
