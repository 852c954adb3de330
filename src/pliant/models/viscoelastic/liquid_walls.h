#pragma once

#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/core/obstacle.h"

namespace pliant {

class Liquid;
template <typename T>
class SphKernels;

/// Obstacles as a liquid feels them: each is, near a particle, a half space that fills what the
/// particle's own kind leaves empty, moves with the obstacle and does not slip. Without it density
/// would fall short at walls. What walls fill depends on distances alone, so that their pressure
/// forces are the gradient of an energy.
class LiquidWalls {
 public:
  /// Looks for particles within `support` of obstacles, in a substep of `dt` [m, s].
  void find(const Positions& x, const std::vector<Obstacle>& obstacles, double support, double dt);
  bool any() const { return !touches_.empty(); }
  /// How much of a particle's surroundings walls fill: 1 − Π (1 − ω) over the walls near it.
  double filling(int particle) const { return 1.0 - open_[particle]; }
  /// Adds the walls' forces, with the densities that `liquid` has just computed.
  void add_forces(const Liquid& liquid, const Particles& particles, const Eigen::VectorXd& beta,
                  Forces& f);
  /// Adds what the drag of add_forces() took of each particle's motion along the walls in the step
  /// of `dt` from x_start and v_start to v [s, J]: its work, less what the walls' motion gave.
  void add_losses(const Liquid& liquid, const Particles& particles, const Eigen::VectorXd& beta,
                  double dt, Eigen::VectorXd& losses) const;
  /// Adds what the particles did to the obstacles, at the positions of the last find().
  void add_reactions(std::vector<Reaction>& reactions) const;
  void clear();

  /// What a wall does to a particle.
  struct Push {
    int particle, obstacle;
    Eigen::Vector3d normal;  ///< of length 1, from the obstacle to the particle, in world axes
    Eigen::Vector3d arm;     ///< from the origin of the obstacle's pose_end [m]
    Eigen::Vector3d force;   ///< on the particle [N]
  };
  /// Of the last step, those that carry force.
  std::vector<Push> pushes() const;

 private:
  struct Touch {
    int particle, obstacle;
    double distance;
    double filling;                    // ω
    Eigen::Vector3d normal, velocity;  // of the wall, in world axes
    Eigen::Vector3d arm;               // from the origin of the obstacle's pose_end [m]
    Eigen::Vector3d force;             // on the particle [N]
  };
  /// The drag of a wall on what slips along it [N] by its `velocity` [m/s].
  static Eigen::Vector3d drag(const Touch& touch, const Liquid& liquid,
                              const SphKernels<double>& kernels, const Eigen::Vector3d& velocity);
  void find_with(int obstacle, const Positions& x, const Obstacle& o, double support, double dt);

  std::vector<Touch> touches_;            // obstacle by obstacle
  std::vector<std::vector<Touch>> runs_;  // of one obstacle, by runs of particles
  Eigen::VectorXd open_;                  // Π (1 − ω)
  // Per obstacle and particle: how far the two may still come nearer before the distance counts.
  std::vector<std::vector<float>> clear_;
  Positions last_;
};

}  // namespace pliant
