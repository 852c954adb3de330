#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pliant/core/body/embedded_points.h"
#include "pliant/core/body/particles.h"

namespace pliant {

/// A force on the particles near a point, as a user asks for it.
struct AppliedForce {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< in world [m]
  double radius = 0.0;  ///< particles within it share the force; 0 takes the nearest one [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< total, in world axes [N]
  double start = 0.0;     ///< simulated time [s]; one in the past starts now
  double duration = 0.0;  ///< [s]; < 0 forever, 0 one step
  int body = -1;          ///< index of the only one that it acts on; -1: all
};

/// Where users' forces act on a body: its particles, or points that these carry.
class ForcePoints {
 public:
  /// Both outlive this; `embedded` null: the particles.
  ForcePoints(const Particles& particles, const EmbeddedPoints* embedded)
      : particles_(&particles), embedded_(embedded) {}

  int size() const { return embedded_ ? embedded_->size() : particles_->size(); }
  Eigen::Vector3d position(int i) const {
    return embedded_ ? embedded_->position(particles_->x, i)
                     : Eigen::Vector3d(particles_->x.col(i));
  }
  /// Its share of the body's [kg].
  double mass(int i) const {
    return embedded_ ? particles_->mass.sum() / embedded_->size() : particles_->mass[i];
  }
  /// Adds a force on one of them to those on the particles [N].
  void add(int i, const Eigen::Vector3d& force, Forces& forces) const;

 private:
  const Particles* particles_;
  const EmbeddedPoints* embedded_;
};

/// The forces that act on a world's bodies. Each picks its particles when it starts and follows
/// them; the force is shared in proportion to mass.
class AppliedForces {
 public:
  struct Active {
    AppliedForce request;
    bool started = false;
    double end = 0.0;
    std::vector<std::vector<int>> points;  ///< of each body
    double mass = 0.0;
  };

  /// Throws InputError for a value that is not finite or a negative radius.
  void add(const AppliedForce& force);
  void clear() { active_.clear(); }
  /// Ends those that act on the body of that index alone. Returns how many there were.
  int clear(int body);
  const std::vector<Active>& active() const { return active_; }

  /// Picks points of forces that start in the step [time, time + dt).
  void begin_step(double time, double dt, const std::vector<ForcePoints>& bodies);
  void add_to(int body, const ForcePoints& points, Forces& forces) const;
  /// Drops those that ended by `time`.
  void end_step(double time);
  bool empty() const { return active_.empty(); }

 private:
  std::vector<Active> active_;
};

}  // namespace pliant
