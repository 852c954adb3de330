#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "pliant/scene/robot/robot.h"

namespace pliant {

/// Finds where a robot's joints have to be for a link to be at a pose, within their limits, by
/// KDL's damped Newton iterations. The same input gives the same answer. One thread at a time.
class InverseKinematics {
 public:
  /// The robot need not live on. Throws InputError for a link that the robot does not have, that no
  /// joint moves, or that a mimicking joint moves.
  InverseKinematics(const Robot& robot, const std::string& link);
  InverseKinematics(InverseKinematics&&) noexcept;
  ~InverseKinematics();

  struct Solution {
    std::vector<double> positions;  ///< of all joints; those that do not move the link are kept
    double distance = 0.0;          ///< from the pose that was asked for [m]
    double angle = 0.0;             ///< [rad]
    bool reached = false;
  };

  /// Indices of the joints that move the link, from the root on.
  const std::vector<int>& joints() const;
  /// The link's pose in the frame of the robot's root link. `positions` has one value a joint.
  Eigen::Isometry3d pose(const std::vector<double>& positions) const;
  /// Goes from `start`, one value a joint. A pose that is not reached gives the nearest one found.
  Solution solve(const Eigen::Isometry3d& root_from_link, const std::vector<double>& start) const;
  /// The same for a pose close to where `start` has the link: no other path there is tried.
  Solution step(const Eigen::Isometry3d& root_from_link, const std::vector<double>& start) const;

  static constexpr double kTolerance = 1e-6;  ///< of a pose that is reached [m and rad]

 private:
  Solution through_waypoints(const Eigen::Isometry3d& root_from_link,
                             const std::vector<double>& start) const;
  void come_nearer(const Eigen::Isometry3d& root_from_link, Solution& best) const;
  void measure(const Eigen::Isometry3d& root_from_link, Solution& solution) const;
  /// The chain's joints somewhere within their limits.
  std::vector<double> other_start(int number, const std::vector<double>& start) const;

  struct Chain;
  std::unique_ptr<Chain> chain_;
};

}  // namespace pliant
