#pragma once

#include <Eigen/Core>

#include "cuda/solvers/resident_run/resident_step.h"
#include "cuda/solvers/scenes/packed_system.h"
#include "pliant/core/step/resident_run.h"

namespace pliant {

/// Where positions of a resident run are measured from, and by.
struct ResidentFrame {
  Eigen::Vector3d center;  ///< [m]
  Eigen::Vector3d extent;  ///< of the body [m]
  double quantum;          ///< [m]
};

/// What moves a body in the steps of a resident run besides its elements, contact and a common
/// acceleration, in the memory of an executor: what its model and its effects do. Of one scene.
template <class Executor>
class ResidentForces {
 public:
  virtual ~ResidentForces() = default;
  /// Whether it takes the run with quanta of that size.
  virtual bool can_take(const ProjectiveSystem& system, const ResidentRun& run,
                        double quantum) const = 0;
  /// Reads what it needs of the system.
  virtual void begin(const ProjectiveSystem& system, const ResidentRun& run,
                     const PackedSystem& packed, const ResidentFrame& frame) = 0;
  /// Before the first step, when the arrays hold the state. From here on nothing is allocated.
  virtual void upload(Executor& executor, const StepArrays& arrays, ResidentArrays& resident) = 0;
  // In each part of a step, by launches that may be captured: before the prediction, adding to the
  // sums of reactions (SumReactions), and after the velocities.
  virtual void before_substep(Executor& executor) = 0;
  virtual void add_reactions(Executor& executor, float share, float* sums) = 0;
  virtual void after_substep(Executor& executor) = 0;
  /// Whether goes_on() wants to know the fastest particle.
  virtual bool watches_speed() const = 0;
  /// `fastest`: squared displacement in a part [quanta²].
  virtual bool goes_on(float fastest) const = 0;
};

}  // namespace pliant
