#include "pliant/solvers/iterations/line_search_jacobi.h"

#include <algorithm>
#include <cmath>

#include "pliant/solvers/device/backend.h"

namespace pliant {

void LineSearchJacobiSolver::prepare_iterations(const ProjectiveSystem& system) {
  relaxation_ = make_relaxation(product(), system.particles);
  direction_.resize(3, system.particles.size());
}

void LineSearchJacobiSolver::weigh() {
  double sum = 0.0;
  for (int i = 0; i < direction_.cols(); ++i) {
    direction_.col(i) = relaxation_.mobility[i] * forces().col(i);
    sum += direction_.col(i).norm();
  }
  const double mean = sum / static_cast<double>(std::max<Eigen::Index>(1, direction_.cols()));
  if (mean == 0.0) return;
  for (int i = 0; i < direction_.cols(); ++i) {
    direction_.col(i) *= std::clamp(direction_.col(i).norm() / mean, 1.0 / spread_, spread_);
  }
}

double LineSearchJacobiSolver::best_step() {
  // argmin over α of 1/2 α² dᵀA d − α dᵀr; A bounds the Hessian of φ from above.
  multiply(matrix(), direction_, product_);
  const double curvature = direction_.cwiseProduct(product_).sum();
  return curvature > 0.0 ? direction_.cwiseProduct(forces()).sum() / curvature : 0.0;
}

bool LineSearchJacobiSolver::iterate(ProjectiveSystem& system, StepReport& report) {
  if (!system.constraints.empty()) {
    // A constraint's projection bounds each particle's own step, which the best common one may
    // pass.
    jacobi_update(system, relaxation_.mobility, report);
    return true;
  }
  weigh();
  step_ = best_step();
  system.particles.x += step_ * direction_;
  return true;
}

void LineSearchJacobiSolver::end_iterations(ProjectiveSystem&, StepReport& report) {
  report.add_metric("relaxation", step_ * relaxation_.gamma);
}

SolverRegistry::Entry line_search_jacobi_entry() {
  std::vector<ParameterSpec> parameters = stop_rule_parameters("50");
  parameters.push_back(number_parameter("spread", "", "2", 1.0, 100.0,
                                        "largest weight of a deformed place, and one over the "
                                        "smallest; 1 weighs all alike"));
  parameters.push_back(backend_parameter());
  return {"line_search_jacobi",
          "jacobi whose strongly deformed places move further, with the best common step; plain "
          "jacobi where there is contact or air",
          parameters, projective_models(), [](const Parameters& given) {
            const StopRule rule = stop_rule(given);
            const double spread = given.number("spread");
            DeviceSolverSpec spec = {"line_search_jacobi", rule};
            spec.iteration = {DeviceIteration::kLineSearch, spread};
            return make_on_backend(given.text("backend"),
                                   std::make_unique<LineSearchJacobiSolver>(rule, spread), spec);
          }};
}

}  // namespace pliant
