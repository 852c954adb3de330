#pragma once

#include "pliant/core/solver.h"

namespace pliant {

/// Every solver of every model: those of projective systems, and the integrators of reduced bodies.
const SolverRegistry& all_solvers();

}  // namespace pliant
