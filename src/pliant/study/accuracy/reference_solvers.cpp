#include "pliant/study/accuracy/reference_solvers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"
#include "pliant/study/accuracy/accuracy_plan.h"

namespace pliant {
namespace {

/// The most exact ones first, and how many iterations each may take.
struct Candidate {
  const char* name;
  int iterations;
};
constexpr Candidate kCandidates[] = {{"newton", 200},
                                     {"lbfgs", 5000},
                                     {"chebyshev", 20000},
                                     {"direct", 5000},
                                     {"jacobi", 200000},
                                     {"xpbd", 50000},
                                     // Of reduced bodies.
                                     {"newmark", 200},
                                     {"midpoint", 200}};
constexpr int kIterationsOfOthers = 50000;
// States to measure from need not be exact.
constexpr const char* kRunners[] = {"chebyshev", "lbfgs"};
constexpr int kRunnerIterations = 1000;
constexpr double kRunnerTolerance = 1e-4;

int iterations_of(const std::string& name) {
  for (const Candidate& candidate : kCandidates) {
    if (candidate.name == name) return candidate.iterations;
  }
  return kIterationsOfOthers;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void check_wished(const std::vector<std::string>& wished) {
  if (wished.size() > 2) {
    throw InputError(fmt::format("--references names {} solvers, but two are compared: write two",
                                 wished.size()));
  }
  for (const std::string& name : wished) {
    all_solvers().find(name);
    if (!takes_iterations(name)) {
      throw InputError(
          fmt::format("--references: {} takes no iterations, so that it does not "
                      "converge to the implicit step; name another solver",
                      name));
    }
  }
  if (wished.size() == 2 && wished[0] == wished[1]) {
    throw InputError(
        fmt::format("--references has {} twice; name two different solvers, which "
                    "check each other",
                    wished[0]));
  }
}

/// As many as it takes, where that is fewer.
int allowed_iterations(const ParameterSpec& spec, int iterations) {
  return static_cast<int>(std::min<double>(iterations, spec.max));
}

SolverSetting converging_setting(const SceneSpec& scene, const std::string& name, int iterations,
                                 double tolerance) {
  SolverSetting setting = solver_setting(scene, name, iterations);
  for (const ParameterSpec& spec : all_solvers().find(name).parameters) {
    if (spec.name == "tolerance") setting.parameters["tolerance"] = fmt::format("{}", tolerance);
    if (spec.name == "iterations" && setting.iterations > 0) {
      setting.iterations = allowed_iterations(spec, setting.iterations);
      setting.parameters["iterations"] = std::to_string(setting.iterations);
    }
  }
  return setting;
}

}  // namespace

std::vector<std::string> choose_references(const std::vector<std::string>& suitable,
                                           const std::vector<std::string>& wished) {
  check_wished(wished);
  std::vector<std::string> references = wished;
  for (const Candidate& candidate : kCandidates) {
    const bool is_new = has(suitable, candidate.name) && !has(references, candidate.name);
    if (references.size() < 2 && is_new) references.emplace_back(candidate.name);
  }
  for (const std::string& name : suitable) {
    const bool is_new = takes_iterations(name) && !has(references, name);
    if (references.size() < 2 && is_new) references.push_back(name);
  }
  if (references.size() < 2) {
    throw InputError(fmt::format(
        "a study needs two solvers that converge to check each other, but the scene's models have "
        "[{}] only",
        fmt::join(references, ", ")));
  }
  return references;
}

SolverSetting reference_setting(const SceneSpec& scene, const std::string& name, double tolerance) {
  return converging_setting(scene, name, iterations_of(name), tolerance);
}

SolverSetting runner_setting(const SceneSpec& scene, const std::vector<std::string>& suitable,
                             const std::string& first_reference) {
  for (const char* runner : kRunners) {
    if (has(suitable, runner)) {
      return converging_setting(scene, runner, kRunnerIterations, kRunnerTolerance);
    }
  }
  return reference_setting(scene, first_reference, kRunnerTolerance);
}

}  // namespace pliant
