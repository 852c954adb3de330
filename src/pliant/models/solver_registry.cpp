#include "pliant/models/solver_registry.h"

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

}  // namespace pliant
