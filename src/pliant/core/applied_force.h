#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pliant/core/particles.h"

namespace pliant {

/// A force on the particles near a point, as a user asks for it.
struct AppliedForce {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< in world [m]
  double radius = 0.0;  ///< particles within it share the force; 0 takes the nearest one [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< total, in world axes [N]
  double start = 0.0;     ///< simulated time [s]; one in the past starts now
  double duration = 0.0;  ///< [s]; < 0 forever, 0 one step
};

/// The forces that act on a world's bodies. Each picks its particles when it starts and follows
/// them; the force is shared in proportion to mass.
class AppliedForces {
 public:
  struct Active {
    AppliedForce request;
    bool started = false;
    double end = 0.0;
    std::vector<std::vector<int>> particles;  ///< of each body
    double mass = 0.0;
  };

  /// Throws InputError for a value that is not finite or a negative radius.
  void add(const AppliedForce& force);
  void clear() { active_.clear(); }
  const std::vector<Active>& active() const { return active_; }

  /// Picks particles of forces that start in the step [time, time + dt).
  void begin_step(double time, double dt, const std::vector<const Particles*>& bodies);
  void add_to(int body, const Particles& particles, Forces& forces) const;
  /// Drops those that ended by `time`.
  void end_step(double time);
  bool empty() const { return active_.empty(); }

 private:
  std::vector<Active> active_;
};

}  // namespace pliant
