#include "pliant/solvers/registry.h"

#include "pliant/solvers/jacobi.h"
#include "pliant/solvers/verlet.h"
#include "pliant/solvers/xpbd.h"

namespace pliant {

const SolverRegistry& solver_registry() {
  static const SolverRegistry registry = [] {
    SolverRegistry built("solver");
    built.add(verlet_entry());
    built.add(xpbd_entry());
    built.add(jacobi_entry());
    return built;
  }();
  return registry;
}

}  // namespace pliant
