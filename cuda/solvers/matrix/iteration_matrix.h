#pragma once

#include <memory>

#include "cuda/solvers/scenes/packed_system.h"
#include "pliant/solvers/device/device_iteration.h"
#include "pliant/solvers/iterations/relaxation.h"
#include "pliant/solvers/linear/multigrid.h"
#include "pliant/solvers/linear/vertex_coloring.h"

namespace pliant {

/// What iterations on a device need to know of a system and its time step.
struct IterationMatrix {
  Relaxation relaxation;     ///< of sweeps γ = 1, and mobilities as GaussSeidelSolver has them
  Eigen::VectorXd diagonal;  ///< of A [N/m]
  SparseRows matrix;         ///< A; empty for Jacobi iterations
  VertexColoring coloring;   ///< of sweeps
  std::shared_ptr<const Multigrid> multigrid;  ///< null: the iteration has none
};

/// Throws InputError for a sweep of more colours than a device takes.
IterationMatrix prepare_iteration(const ProjectiveSystem& system, double dt,
                                  const DeviceIteration& iteration);

/// Of a packed system; `inertia` M/h² [N/m].
PackedMatrix pack_matrix(const IterationMatrix& prepared, const DeviceIteration& iteration,
                         const Eigen::VectorXd& inertia, const PackedSystem& packed);

}  // namespace pliant
