#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "pliant/solvers/registry.h"
#include "support/known_defects.h"

namespace pliant {

// What theory says of the solvers of cloth. One that is not named here is taken for what most are:
// implicit Euler, iterated.

/// Position Verlet; all others step by implicit Euler.
inline bool is_explicit(const std::string& solver) { return solver == "verlet"; }

/// Whether any number of iterations keeps momentum: forces act in pairs there, or move all
/// particles at once by the exact masses. The others move each particle by its own share of a force
/// and keep momentum as far as they converge.
inline bool keeps_momentum(const std::string& solver) {
  return is_explicit(solver) || solver == "xpbd" || solver == "direct" || solver == "newton";
}

/// Bound on the energy at any time over that at the start. Position Verlet keeps
/// v²/2 - h w² x v / 2 + w² x² / 2 of a mode w exactly, so that the energy, taken from x and the
/// velocity half a step before, swings by (1 + a) / (1 - a) at most, a = h w / 2: by 3 at half the
/// largest step. Implicit Euler only loses energy.
inline double energy_swing(const std::string& solver) { return is_explicit(solver) ? 3.0 : 1.0; }

/// So many `iterations` and no other stop rule; nothing for a solver without iterations.
inline ParameterText with_iterations(const std::string& solver, int iterations) {
  if (is_explicit(solver)) return {};
  return {{"iterations", std::to_string(iterations)}, {"tolerance", "0"}};
}

/// So many iterations at the most, fewer where they have converged to round-off.
inline ParameterText up_to_iterations(const std::string& solver, int most) {
  ParameterText parameters = with_iterations(solver, most);
  // The residual holds how springs turn, which xpbd leaves out.
  if (!parameters.empty() && solver != "xpbd") parameters["tolerance"] = "1e-13";
  return parameters;
}

/// Iterations that leave only round-off of the error of a step whose springs are no stiffer than
/// its inertia, as soft_material() is at 1 ms: each halves the error.
inline ParameterText converged(const std::string& solver) {
  return up_to_iterations(solver, solver == "xpbd" ? 100 : 200);
}

/// Few iterations, as real time has them; nothing for a solver without. Those that solve for all
/// particles at once take fewer.
inline ParameterText few_iterations(const std::string& solver, int few) {
  if (is_explicit(solver)) return {};
  if (solver == "newton") few = 3;
  if (solver == "direct" || solver == "lbfgs") few = 10;
  return {{"iterations", std::to_string(few)}};
}

inline std::vector<std::string> cloth_solvers() { return solver_registry().names_for("cloth"); }

inline std::vector<std::string> cloth_solvers_that_are_explicit(bool wanted) {
  std::vector<std::string> names;
  for (const std::string& name : cloth_solvers()) {
    if (is_explicit(name) == wanted) names.push_back(name);
  }
  return names;
}

inline std::string test_name_of(const testing::TestParamInfo<std::string>& info) {
  return info.param;
}

/// Tests that hold for every solver of cloth.
class EverySolver : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (const char* seen = known_defect()) GTEST_SKIP() << "known defect: " << seen;
  }
  const std::string& solver() const { return GetParam(); }
};

}  // namespace pliant

/// Runs the TEST_Ps of `suite`, a class derived from EverySolver, for each solver of cloth, ...
#define PLIANT_FOR_EVERY_SOLVER(suite) \
  INSTANTIATE_TEST_SUITE_P(Solvers, suite, testing::ValuesIn(cloth_solvers()), test_name_of)

/// ... or for those of one kind.
#define PLIANT_FOR_IMPLICIT_SOLVERS(suite) \
  INSTANTIATE_TEST_SUITE_P(                \
      Solvers, suite, testing::ValuesIn(cloth_solvers_that_are_explicit(false)), test_name_of)
#define PLIANT_FOR_EXPLICIT_SOLVERS(suite) \
  INSTANTIATE_TEST_SUITE_P(Solvers, suite, \
                           testing::ValuesIn(cloth_solvers_that_are_explicit(true)), test_name_of)
