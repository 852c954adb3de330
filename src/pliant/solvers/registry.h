#pragma once

#include "pliant/core/solver.h"

namespace pliant {

/// Every built-in solver.
const SolverRegistry& solver_registry();

}  // namespace pliant
