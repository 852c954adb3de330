#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/system/system.h"

namespace pliant {

/// How rigid bodies turn in a step, and what is said of their particles with them. A ball that
/// rolls fast turns by a radian in a step: what its particles were off by the end of the last step
/// is no motion of a rigid body where they are now, unless it turned with them.
class RigidTurns {
 public:
  void prepare(const ProjectiveSystem& system);
  /// The turns of `steps` steps as the last one was, which took `particles` from x_start to x.
  void find(const Particles& particles, double steps);
  /// Turns what lies about the mean of each body in `d`, a vector for each particle.
  void apply(Eigen::Matrix3Xd& d) const;

 private:
  struct Member {
    int particle;
    double mass;
  };
  struct Body {
    std::vector<Member> members;
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  };
  static Eigen::Vector3d mean(const Body& body, const Eigen::Matrix3Xd& d);
  std::vector<Body> bodies_;
};

}  // namespace pliant
