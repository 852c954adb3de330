#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pliant/core/applied_force.h"
#include "pliant/core/particles.h"

namespace pliant {

/// What an effect or an element set keeps from one step to the next beside positions and
/// velocities, as numbers. They are read back in the order in which they were written.
class SavedNumbers {
 public:
  void write(double value) { values_.push_back(value); }
  /// The next number; NaN after the last one.
  double read();
  /// Every coefficient of a dense matrix or vector, and back.
  template <class Matrix>
  void write_all(const Matrix& values) {
    for (Eigen::Index k = 0; k < values.size(); ++k) write(values.data()[k]);
  }
  template <class Matrix>
  void read_all(Matrix& values) {
    for (Eigen::Index k = 0; k < values.size(); ++k) values.data()[k] = read();
  }
  void rewind() { next_ = 0; }
  std::size_t size() const { return values_.size(); }

 private:
  std::vector<double> values_;
  std::size_t next_ = 0;
};

/// All that a world needs to go on bit for bit from where it was saved, whatever happened to it
/// since. Solvers keep nothing that belongs here (core/solver.h).
struct Checkpoint {
  struct BodyState {
    std::string name;
    Particles particles;
    std::vector<std::string> effects;  ///< names, in order
    SavedNumbers numbers;              ///< of the element sets, then of the effects
  };
  struct ObstaclePoses {
    Eigen::Isometry3d start, end;  ///< world from shape
  };

  double time_step = 0.0;   ///< [s]
  double time = 0.0;        ///< [s]
  std::uint64_t steps = 0;  ///< since the start or the last reset
  std::vector<BodyState> bodies;
  std::vector<ObstaclePoses> obstacles;
  AppliedForces applied_forces;
};

}  // namespace pliant
