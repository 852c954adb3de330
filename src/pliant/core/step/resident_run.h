#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "pliant/core/obstacle.h"
#include "pliant/core/step/readback.h"

namespace pliant {

class EmbeddedPoints;
struct ParticleResidentRun;

/// Several steps of one body on end that nobody observes in between, among obstacles that stand
/// still: what its model and its effects do in each of them, told in advance, for solvers that take
/// them while the body's state stays on a device (solver.h). Effects join one by one (effect.h),
/// after the model.
struct ResidentRun {
  int steps = 0;
  /// So many more come after them, of which all that is told here holds: the solver may begin with
  /// them while somebody observes where these end. 0: none.
  int follow = 0;
  /// It comes after another run, and nobody changed the body in between.
  bool continues = false;
  /// What is to be read back at its end; the solver may read back more.
  Readback readback = Readback::kState;
  /// The vertices of what is drawn; null: the particles.
  const EmbeddedPoints* surface = nullptr;
  double step_time = 0.0;                                  ///< of a whole step [s]
  int substeps = 1;                                        ///< equal ones, of each step
  double dt = 0.0;                                         ///< of one substep [s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< of every particle [m/s²]
  double velocity_factor = 1.0;                            ///< on velocities after each substep
  const std::vector<Obstacle>* obstacles = nullptr;
  // As FiniteCheck bounds each step.
  double max_speed = 0.0;     ///< [m/s]
  double max_distance = 0.0;  ///< from the origin [m]
  /// Of a body of particles; else null.
  std::shared_ptr<ParticleResidentRun> particles = nullptr;
};

}  // namespace pliant
