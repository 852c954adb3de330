#pragma once

#include <vector>

#include "pliant/core/system/system.h"

namespace pliant {

/// By how much a step misses Newton's second law. Forces between elements change neither the
/// momentum nor the angular momentum of a connected component that nothing holds from outside, so
/// that with velocities v at a step's end, v₀ at its beginning, the external forces f and the told
/// forces of contact c
///   Σ m (v − v₀) = h Σ (f + c),   Σ q × m (v − v₀) = h Σ q × (f + c),
/// q seen from the component's centre. Elements that turn particles which have an orientation have
/// a torque besides.
class ImpulseImbalance {
 public:
  /// The system's structure changed.
  void prepare(const ProjectiveSystem& system);
  /// Whether there are such components, of more than one particle.
  bool is_known() const { return !members_.empty(); }
  /// After a step of `dt` [s], with its velocities: what either equation misses in the worst
  /// component, over h Σ (|f| + |c|) + Σ m |v − v₀|; the second over that times the distance of
  /// particles from the centre. 0 is right, 1 is as bad as no force at all.
  double find(const ProjectiveSystem& system, double dt);

 private:
  /// Of particles of a component.
  struct Sums {
    Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  // that is missed [N s]
    Eigen::Vector3d twist = Eigen::Vector3d::Zero();    // [N m s]
    double impulse_size = 0.0, twist_size = 0.0;
  };
  static Sums joined(const Sums& a, const Sums& b);
  double find(const ProjectiveSystem& system, double dt, int begin, int end) const;

  std::vector<int> members_;  // of free components, one after the other
  std::vector<int> begins_;   // of each one's members, and the end of the last one's
  Forces contact_;            // [N]
  Forces twisting_;           // of elements that have a torque [N]; empty: none has
};

}  // namespace pliant
