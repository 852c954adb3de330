#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/obstacle.h"

namespace pliant {

/// Several steps of one body on end that nobody looks at in between, among obstacles that stand
/// still: what its effects do in each of them, told in advance, for solvers that take them without
/// coming back (solver.h). Effects join one by one (effect.h).
struct StepSeries {
  int steps = 0;
  double dt = 0.0;                                         ///< of one of them [s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< of every particle [m/s²]
  double velocity_factor = 1.0;                            ///< on velocities after each step
  const std::vector<Obstacle>* obstacles = nullptr;
};

}  // namespace pliant
