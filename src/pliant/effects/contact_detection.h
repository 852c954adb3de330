#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/obstacle.h"
#include "pliant/core/particles.h"

namespace pliant {

/// A particle near an obstacle: it must stay where normal . x >= plane.
struct Contact {
  int particle = 0;
  int obstacle = 0;
  Eigen::Vector3d normal;          ///< away from the obstacle, world axes
  double plane = 0.0;              ///< [m]
  Eigen::Vector3d surface_motion;  ///< of the touched surface over the step [m]
  double normal_force = 0.0;       ///< multiplier [N], >= 0
  int corrections = 0;             ///< of a solver that moves all particles, which held it so far
  /// Direction in which the last of these corrections let it slide, zero where it stuck.
  Eigen::Vector3d slide = Eigen::Vector3d::Zero();
  Eigen::Vector3d friction_force = Eigen::Vector3d::Zero();  ///< multiplier [N], tangential
};

/// Finds contacts of particles that move from x_start to x in a step with obstacles that move from
/// pose_start to pose_end, continuously: nothing tunnels, however thin or fast.
class ContactDetection {
 public:
  /// Particles are kept `offset` away from surfaces; contacts open by less than `margin` are found
  /// too [m]. Obstacles outlive this.
  ContactDetection(const std::vector<Obstacle>& obstacles, double offset, double margin);

  /// Appends the contacts of the step to `contacts`, obstacle by obstacle, particle by particle.
  void find(const Particles& particles, double dt, std::vector<Contact>& contacts);
  double offset() const { return offset_; }

 private:
  struct Sight;  // one obstacle as the loop over particles needs it
  void find_with(int obstacle, const Particles& particles, double reach_of_motion, double dt,
                 std::vector<Contact>& contacts);

  const std::vector<Obstacle>& obstacles_;
  double offset_;
  double margin_;
  // Per obstacle and particle: a point in the obstacle's frame and the radius of a ball about it
  // that holds no contact. While a particle stays in its ball, no distance is computed.
  std::vector<std::vector<Eigen::Vector4f>> clear_balls_;
};

}  // namespace pliant
