#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/system/system.h"

namespace pliant {

/// How rigid bodies turned in a step, to turn displacements of their particles with them. A ball
/// that rolls fast turns by a radian in a step: displacements that were a motion of the whole body
/// before the step bend it where its particles are now, unless they turn too.
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
