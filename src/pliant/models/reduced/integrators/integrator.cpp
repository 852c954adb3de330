#include "pliant/models/reduced/integrators/integrator.h"

namespace pliant {

void Integrator::prepare(System& system, double dt) {
  prepare_step(dynamic_cast<ReducedSystem&>(system), dt);
}

void Integrator::step(System& system, double dt, StepReport& report) {
  report.solver = name();
  advance(dynamic_cast<ReducedSystem&>(system), dt, report);
}

}  // namespace pliant
