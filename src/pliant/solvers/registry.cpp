#include "pliant/solvers/registry.h"

#include "pliant/core/add_new.h"
#include "pliant/solvers/iterations/chebyshev.h"
#include "pliant/solvers/iterations/direct.h"
#include "pliant/solvers/iterations/gauss_seidel.h"
#include "pliant/solvers/iterations/jacobi.h"
#include "pliant/solvers/iterations/lbfgs.h"
#include "pliant/solvers/iterations/line_search_jacobi.h"
#include "pliant/solvers/iterations/newton.h"
#include "pliant/solvers/iterations/shape_matching.h"
#include "pliant/solvers/iterations/verlet.h"
#include "pliant/solvers/iterations/xpbd.h"

namespace pliant {
namespace {

SolverRegistry& solver_entries() {
  static SolverRegistry registry = [] {
    SolverRegistry built("solver");
    built.add(verlet_entry());
    built.add(xpbd_entry());
    built.add(jacobi_entry());
    built.add(line_search_jacobi_entry());
    built.add(gauss_seidel_entry());
    built.add(hybrid_entry());
    built.add(shape_matching_entry());
    built.add(chebyshev_entry());
    built.add(direct_entry());
    built.add(lbfgs_entry());
    built.add(newton_entry());
    return built;
  }();
  return registry;
}

}  // namespace

const SolverRegistry& solver_registry() { return solver_entries(); }

void add_solver(SolverRegistry::Entry entry) { add_new(std::move(entry), solver_entries()); }

}  // namespace pliant
