#include "pliant/scene/robot/motion/inverse_kinematics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_nr_jl.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#include <kdl/chainiksolvervel_wdls.hpp>
#include <limits>

#include "pliant/math/error.h"
#include "pliant/math/pi.h"
#include "pliant/scene/robot/robot_data.h"

namespace pliant {
namespace {

constexpr unsigned int kIterations = 300;
constexpr int kWaypoints = 50;
constexpr int kOtherStarts = 12;
constexpr int kRefinements = 40;  // of the nearest pose found, where none is reached
// Singular values of the Jacobian below kNearSingular are damped, so that the arm neither jumps
// near a singular configuration nor fails when it is asked for more than it reaches.
constexpr double kNearSingular = 0.05;
constexpr double kDamping = 0.02;
constexpr double kFarDamping = 0.1;           // the same where the path is long
constexpr unsigned int kLeastForDamping = 6;  // joints: with fewer, KDL's damped solver aborts
constexpr double kAngleWeight = 0.2;          // metres of distance that count as much as a radian

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

Eigen::Isometry3d between(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to,
                          double share) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = from.translation() + share * (to.translation() - from.translation());
  pose.linear() = Eigen::Quaterniond(from.linear())
                      .slerp(share, Eigen::Quaterniond(to.linear()))
                      .toRotationMatrix();
  return pose;
}

double error_of(const InverseKinematics::Solution& solution) {
  return solution.distance + kAngleWeight * solution.angle;
}

}  // namespace

struct InverseKinematics::Chain {
  std::vector<int> joints;
  KDL::Chain chain;
  KDL::JntArray lower, upper;
  std::unique_ptr<KDL::ChainFkSolverPos_recursive> forward;
  std::unique_ptr<KDL::ChainIkSolverVel> velocity;
  KDL::ChainIkSolverVel_wdls* damped = nullptr;  // is `velocity`, where the chain is long enough
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
    if (part.free >= 0) {
      const Robot::FreeJoint& free = robot.free_joints[static_cast<std::size_t>(part.free)];
      throw InputError(fmt::format(
          "link '{}' hangs on joint '{}', which is {}: inverse kinematics does not know where tf "
          "puts it; give joint positions",
          name, free.name, free.type));
    }
    chain.addSegment(part.segment);
    if (joint.getType() == KDL::Joint::None) continue;
    if (robot.passive_joints.count(robot.prefix + joint.getName()) > 0) {
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
  if (chain.getNrOfJoints() < kLeastForDamping) {
    velocity = std::make_unique<KDL::ChainIkSolverVel_pinv>(chain);
  } else {
    auto solver = std::make_unique<KDL::ChainIkSolverVel_wdls>(chain);
    damped = solver.get();
    damped->setEps(kNearSingular);
    damped->setLambda(kDamping);
    velocity = std::move(solver);
  }
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
  measure(root_from_link, solution);
  solution.reached = result == KDL::SolverI::E_NOERROR;
  return solution;
}

void InverseKinematics::measure(const Eigen::Isometry3d& root_from_link, Solution& solution) const {
  const Eigen::Isometry3d error = pose(solution.positions).inverse() * root_from_link;
  solution.distance = error.translation().norm();
  solution.angle = Eigen::AngleAxisd(error.rotation()).angle();
}

InverseKinematics::Solution InverseKinematics::through_waypoints(
    const Eigen::Isometry3d& root_from_link, const std::vector<double>& start) const {
  Solution solution{start};
  const Eigen::Isometry3d from = pose(start);
  for (int k = 1; k < kWaypoints; ++k) {
    const double share = static_cast<double>(k) / kWaypoints;
    solution = step(between(from, root_from_link, share), solution.positions);
  }
  return step(root_from_link, solution.positions);
}

void InverseKinematics::come_nearer(const Eigen::Isometry3d& root_from_link, Solution& best) const {
  // Newton's iterations towards a far place that is out of reach swing to and fro: short steps.
  double share = 0.1;
  for (int k = 0; k < kRefinements; ++k) {
    Solution next = step(between(pose(best.positions), root_from_link, share), best.positions);
    next.reached = false;
    measure(root_from_link, next);
    if (error_of(next) < error_of(best)) {
      best = std::move(next);
    } else {
      share *= 0.5;
    }
  }
}

std::vector<double> InverseKinematics::other_start(int number,
                                                   const std::vector<double>& start) const {
  std::vector<double> positions = start;
  for (std::size_t j = 0; j < chain_->joints.size(); ++j) {
    const auto row = static_cast<unsigned int>(j);
    const double lower = std::max(chain_->lower(row), -kPi),
                 upper = std::min(chain_->upper(row), kPi);
    // Places spread over the box of the limits: multiples of the roots of primes, modulo 1.
    constexpr std::array<double, 8> kRoots = {1.41421356, 1.73205081, 2.23606798, 2.64575131,
                                              3.31662479, 3.60555128, 4.12310563, 4.35889894};
    const double share = std::fmod(number * kRoots[j % kRoots.size()], 1.0);
    positions[static_cast<std::size_t>(chain_->joints[j])] = lower + share * (upper - lower);
  }
  return positions;
}

InverseKinematics::Solution InverseKinematics::solve(const Eigen::Isometry3d& root_from_link,
                                                     const std::vector<double>& start) const {
  Solution best = step(root_from_link, start);
  const auto take = [&](Solution next) {
    if (next.reached || error_of(next) < error_of(best)) best = std::move(next);
  };
  // Far away, Newton's iterations run into the limits: many short paths instead of a long one.
  if (chain_->damped != nullptr) chain_->damped->setLambda(kFarDamping);
  if (!best.reached) take(through_waypoints(root_from_link, start));
  for (int k = 1; k <= kOtherStarts && !best.reached; ++k) {
    take(step(root_from_link, other_start(k, start)));
  }
  if (chain_->damped != nullptr) chain_->damped->setLambda(kDamping);
  if (!best.reached) come_nearer(root_from_link, best);
  return best;
}

}  // namespace pliant
