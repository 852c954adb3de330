#include "pliant/study/experiments/explicit_steps.h"

#include <algorithm>
#include <functional>

#include "pliant/models/solver_registry.h"
#include "pliant/scene/scene.h"
#include "pliant/study/accuracy/accuracy_plan.h"

namespace pliant {
namespace {

constexpr int kMaxHalvings = 20;

/// The solver as it takes each step whole.
SolverSetting with_whole_steps(SolverSetting solver) {
  for (const ParameterSpec& spec : all_solvers().find(solver.name).parameters) {
    if (spec.name == "max_substeps") solver.parameters[spec.name] = "1";
  }
  return solver;
}

bool is_stable(const SceneSpec& scene, const SolverSetting& solver, double time_step) {
  const auto world = build_world(scene_with(scene, solver, time_step));
  if (!world->step()) return false;
  for (const Body& body : world->bodies()) {
    for (const std::string& warning : body.report.warnings) {
      if (warning.rfind("unstable_step", 0) == 0) return false;
    }
  }
  return true;
}

double stable_time_step(const SceneSpec& scene, const SolverSetting& solver, double wished) {
  double step = wished;
  for (int k = 0; k <= kMaxHalvings; ++k, step *= 0.5) {
    if (is_stable(scene, solver, step)) return step;
  }
  return wished;
}

}  // namespace

std::vector<double> explicit_time_steps(const SceneSpec& scene, const SolverSetting& solver,
                                        const std::vector<double>& wished) {
  std::vector<double> steps;
  const SolverSetting whole = with_whole_steps(solver);
  for (double step : wished) steps.push_back(stable_time_step(scene, whole, step));
  std::sort(steps.begin(), steps.end(), std::greater<double>());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  steps.push_back(0.5 * steps.back());
  return steps;
}

}  // namespace pliant
