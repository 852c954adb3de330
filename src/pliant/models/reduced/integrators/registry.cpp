#include "pliant/models/reduced/integrators/imex_thesis.h"
#include "pliant/models/reduced/integrators/midpoint.h"
#include "pliant/models/reduced/integrators/newmark.h"
#include "pliant/models/reduced/integrators/stoermer_verlet.h"
#include "pliant/models/reduced/integrators/trigonometric.h"

namespace pliant {

const SolverRegistry& integrator_registry() {
  static const SolverRegistry registry = [] {
    SolverRegistry built("integrator");
    built.add(Trigonometric::entry());
    built.add(ImexThesis::entry());
    built.add(Newmark::entry());
    built.add(Midpoint::entry());
    built.add(StoermerVerlet::entry());
    built.add(Reference::entry());
    return built;
  }();
  return registry;
}

}  // namespace pliant
