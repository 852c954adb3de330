#include "pliant/models/solver_registry.h"

#include <map>

#include "pliant/math/error.h"
#include "pliant/models/reduced/integrators/integrator.h"
#include "pliant/solvers/registry.h"

namespace pliant {

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

const std::string& default_solver(const std::string& model) {
  static const std::map<std::string, std::string> defaults = {
      {"cloth", "xpbd"}, {"patch", "lbfgs"}, {"reduced", "imex"}, {"viscoelastic", "jacobi"}};
  const auto found = defaults.find(model);
  if (found == defaults.end()) throw InputError("model '" + model + "' has no default solver");
  return found->second;
}

}  // namespace pliant
