#include "pliant/solvers/iterations/jacobi.h"

#include <cmath>

#include "pliant/solvers/device/backend.h"

namespace pliant {

void JacobiSolver::prepare_iterations(const ProjectiveSystem& system) {
  relaxation_ = make_relaxation(product(), system.particles);
}

void JacobiSolver::begin_iterations(ProjectiveSystem&, StepReport& report) {
  report.add_metric("relaxation", relaxation_.gamma);
}

bool JacobiSolver::iterate(ProjectiveSystem& system, StepReport& report) {
  jacobi_update(system, relaxation_.mobility, report);
  return true;
}

SolverRegistry::Entry jacobi_entry() {
  std::vector<ParameterSpec> parameters = stop_rule_parameters("50");
  parameters.push_back(backend_parameter());
  return {"jacobi",
          "projective dynamics by Jacobi iterations; never diverges, slow on stiff or fine bodies",
          parameters, projective_models(), [](const Parameters& given) {
            const StopRule rule = stop_rule(given);
            return make_on_backend(given.text("backend"), std::make_unique<JacobiSolver>(rule),
                                   {"jacobi", rule});
          }};
}

}  // namespace pliant
