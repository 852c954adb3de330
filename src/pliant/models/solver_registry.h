#pragma once

#include <string>

#include "pliant/core/solver.h"

namespace pliant {

/// Every solver of every model: those of projective systems, and the integrators of reduced bodies.
const SolverRegistry& all_solvers();

/// What moves bodies of a model in a scene that names no solver. Throws InputError for a model
/// without one.
const std::string& default_solver(const std::string& model);

}  // namespace pliant
