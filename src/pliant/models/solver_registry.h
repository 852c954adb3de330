#pragma once

#include <string>
#include <vector>

#include "pliant/core/solver.h"

namespace pliant {

/// Every solver of every model: those of projective systems, and the integrators of reduced bodies.
const SolverRegistry& all_solvers();
/// As all_solvers().find(); the refusal of a name that is no more says what took its place.
const SolverRegistry::Entry& find_solver(const std::string& name);

/// What moves bodies of a model in a scene that names no solver.
struct DefaultSolver {
  std::string name;
  ParameterText parameters;
  std::string text() const;  ///< as a scene would give it
};
/// What moves bodies of a model wherever they are, on a GPU too; default_solver_among() knows what
/// is better where all of a scene is known. Throws InputError for a model without one.
const DefaultSolver& default_solver(const std::string& model);
/// What moves cloth that nothing stops, and cloth, solids and rigid bodies together.
const DefaultSolver& default_newton();
/// Of solids alone: right for stiff and slender ones too, for which `lbfgs` is not.
const DefaultSolver& default_newton_of_solids();
/// Of a few rigid bodies alone.
const DefaultSolver& default_newton_of_rigid();
/// Of cloth that hangs from what holds it and may touch obstacles. By a residual: that an estimate
/// is small says little of a swing, in which the errors of all steps add up.
const DefaultSolver& default_newton_of_held();
/// What moves a body of `model` among bodies of `models`, its own with it, that may touch and name
/// no solver. Cloth, solids and rigid bodies beside each other take `newton` where it moves them
/// `as_one`, and so do solids alone and a few rigid bodies alone; otherwise, and with others, those
/// of models with other defaults are moved in lockstep (solvers/iterations/lockstep.h).
DefaultSolver default_solver_among(const std::string& model, const std::vector<std::string>& models,
                                   bool as_one);
/// Bodies of more vertices take no solver with a factor by default: it needs memory and time.
constexpr int kMostForDefault = 20000;
/// What moves these instead.
DefaultSolver default_solver_of_large(const DefaultSolver& solver);
/// The same where a GPU may take it, which estimates no errors.
DefaultSolver default_solver_on_gpu(const DefaultSolver& solver);

}  // namespace pliant
