#pragma once

#include "pliant/core/solver.h"

namespace pliant {

/// Every solver of particles: Pliant's own, and those that were added.
const SolverRegistry& solver_registry();

/// Adds one of another package, before a scene is loaded. Throws InputError where the name
/// is taken.
void add_solver(SolverRegistry::Entry entry);

}  // namespace pliant
