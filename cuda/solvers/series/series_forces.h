#pragma once

#include <Eigen/Core>

#include "cuda/solvers/scenes/packed_system.h"
#include "cuda/solvers/series/series_step.h"
#include "pliant/core/step/step_series.h"

namespace pliant {

/// Where positions of a series are measured from, and by.
struct SeriesFrame {
  Eigen::Vector3d center;  ///< [m]
  Eigen::Vector3d extent;  ///< of the body [m]
  double quantum;          ///< [m]
};

/// What moves a body in the steps of a series besides its elements, contact and a common
/// acceleration, in the memory of an executor: what its model and its effects do. Of one scene.
template <class Executor>
class SeriesForces {
 public:
  virtual ~SeriesForces() = default;
  /// Whether it takes the series with quanta of that size.
  virtual bool can_take(const ProjectiveSystem& system, const StepSeries& series,
                        double quantum) const = 0;
  /// Reads what it needs of the system.
  virtual void begin(const ProjectiveSystem& system, const StepSeries& series,
                     const PackedSystem& packed, const SeriesFrame& frame) = 0;
  /// Before the first step, when the arrays hold the state. From here on nothing is allocated.
  virtual void upload(Executor& executor, const StepArrays& arrays, SeriesArrays& series) = 0;
  // In each part of a step, by launches that may be captured: before the prediction, adding to the
  // sums of reactions (SumReactions), and after the velocities.
  virtual void before_part(Executor& executor) = 0;
  virtual void add_reactions(Executor& executor, float share, float* sums) = 0;
  virtual void after_part(Executor& executor) = 0;
  /// Whether goes_on() wants to know the fastest particle.
  virtual bool watches_speed() const = 0;
  /// `fastest`: squared way in a part [quanta²].
  virtual bool goes_on(float fastest) const = 0;
};

}  // namespace pliant
