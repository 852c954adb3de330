#include "pliant/models/solver_registry.h"

#include <algorithm>
#include <map>

#include "pliant/math/error.h"
#include "pliant/models/reduced/integrators/integrator.h"
#include "pliant/solvers/registry.h"

namespace pliant {
namespace {
// Models whose bodies newton moves together by default.
bool takes_newton(const std::string& model) {
  return model == "cloth" || model == "patch" || model == "rigid";
}

// Of cloth and rigid bodies beside others, which ten corrections move. A strip of cloth that falls
// over a soft ball and a box is 10 % off with 100, 4 % with these.
const char* const kSweepsInLockstep = "400";

// Of so many rigid bodies newton moves all. A can that falls on its rim is 46 % off with fifty
// sweeps, three boxes in a stack whose uppermost is ten times as dense 23 %, and sweeps take longer
// there; where many touch, they cost a part of newton's corrections.
constexpr std::size_t kFewRigid = 5;
}  // namespace

const SolverRegistry& all_solvers() {
  static const SolverRegistry registry = [] {
    SolverRegistry built("solver");
    for (const SolverRegistry* part : {&solver_registry(), &integrator_registry()}) {
      for (const SolverRegistry::Entry& entry : part->entries()) built.add(entry);
    }
    return built;
  }();
  return registry;
}

const SolverRegistry::Entry& find_solver(const std::string& name) {
  if (name == "imex") {
    throw InputError(
        "solver 'imex' is no more: 'trigonometric' took its place, whose bodies ring at their own "
        "frequencies (other parameters); the thesis's form is 'imex_thesis'");
  }
  if (name == "weighted_jacobi") {
    throw InputError(
        "solver 'weighted_jacobi' is no more: it weighed particles and is 'line_search_jacobi' "
        "now; the thesis's, which weighs clusters, is 'shape_matching' with 'sweep: "
        "weighted_jacobi', for viscoelastic bodies");
  }
  return all_solvers().find(name);
}

std::string DefaultSolver::text() const {
  std::string text = "{name: " + name;
  for (const auto& [key, value] : parameters) text += ", " + key + ": " + value;
  return text + "}";
}

const DefaultSolver& default_solver(const std::string& model) {
  static const std::map<std::string, DefaultSolver> defaults = {
      {"cloth", {"xpbd", {{"error", "0.03"}, {"most_iterations", "200"}}}},
      {"patch", {"lbfgs", {{"error", "0.03"}, {"most_iterations", "40"}}}},
      {"reduced", {"trigonometric", {}}},
      {"viscoelastic", {"jacobi", {}}},
      {"rigid", {"xpbd", {{"iterations", "50"}}}}};
  const auto found = defaults.find(model);
  if (found == defaults.end()) throw InputError("model '" + model + "' has no default solver");
  return found->second;
}

const DefaultSolver& default_newton() {
  static const DefaultSolver newton = {
      "newton", {{"error", "0.03"}, {"iterations", "20"}, {"linear_tolerance", "0.03"}}};
  return newton;
}

const DefaultSolver& default_newton_of_solids() {
  static const DefaultSolver newton = {
      "newton", {{"error", "0.03"}, {"iterations", "50"}, {"linear_tolerance", "1e-3"}}};
  return newton;
}

const DefaultSolver& default_newton_of_rigid() {
  // What rolls gains speed of what larger residuals leave: 1 % of its energy in a second.
  static const DefaultSolver newton = {"newton",
                                       {{"error", "0.03"},
                                        {"tolerance", "1e-4"},
                                        {"iterations", "50"},
                                        {"linear_tolerance", "0.03"}}};
  return newton;
}

const DefaultSolver& default_newton_of_held() {
  static const DefaultSolver newton = {
      "newton", {{"tolerance", "1e-3"}, {"iterations", "50"}, {"linear_tolerance", "0.03"}}};
  return newton;
}

DefaultSolver default_solver_among(const std::string& model, const std::vector<std::string>& models,
                                   bool as_one) {
  const DefaultSolver& own = default_solver(model);
  if (model == "reduced") return own;
  if (std::all_of(models.begin(), models.end(), [&](const auto& each) { return each == model; })) {
    if (as_one && model == "patch") return default_newton_of_solids();
    if (as_one && model == "rigid" && models.size() <= kFewRigid) return default_newton_of_rigid();
    return own;
  }
  if (as_one && std::all_of(models.begin(), models.end(), takes_newton)) return default_newton();
  const bool is_swept = model == "cloth" || model == "rigid";
  return is_swept ? DefaultSolver{"xpbd", {{"iterations", kSweepsInLockstep}}}
                  : DefaultSolver{"lbfgs", {}};
}

DefaultSolver default_solver_of_large(const DefaultSolver& solver) {
  // An asked error would set nothing beyond 30,000 vertices, where none is estimated.
  return {solver.name == "lbfgs" ? "chebyshev" : solver.name, {}};
}

DefaultSolver default_solver_on_gpu(const DefaultSolver& solver) {
  DefaultSolver there = solver;
  const std::vector<ParameterSpec>& known = all_solvers().find(solver.name).parameters;
  const bool has_form = std::any_of(
      known.begin(), known.end(), [](const ParameterSpec& spec) { return spec.name == "backend"; });
  if (!has_form) return there;
  for (const char* key : {"error", "most_iterations"}) there.parameters.erase(key);
  return there;
}

}  // namespace pliant
