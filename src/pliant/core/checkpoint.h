#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "pliant/core/body/applied_force.h"
#include "pliant/core/body/field_ramps.h"
#include "pliant/core/body/particles.h"
#include "pliant/core/state_archive.h"

namespace pliant {

/// All that a world needs to go on bit for bit from where it was saved, whatever happened to it
/// since, with the same solvers. Another solver keeps what it has learned itself.
struct Checkpoint {
  struct BodyState {
    std::string name;
    Particles particles;
    std::vector<std::string> effects;  ///< names, in order
    StateArchive numbers;              ///< of the system, then of the effects
    std::string solver;                ///< name
    StateArchive learned;              ///< by that solver
    double solver_dt = 0.0;            ///< the step it was prepared for [s]
    double effective_dt = 0.0;         ///< of an integration of second order, its own [s]; else 0
  };
  struct ObstaclePoses {
    Eigen::Isometry3d start, end;  ///< world from shape
  };

  double time_step = 0.0;   ///< [s]
  double time = 0.0;        ///< [s]
  std::uint64_t steps = 0;  ///< since the start or the last reset
  std::vector<BodyState> bodies;
  std::vector<ObstaclePoses> obstacles;
  StateArchive driven;  ///< of what moves them
  AppliedForces applied_forces;
  FieldRamps field_ramps;
};

}  // namespace pliant
