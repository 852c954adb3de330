#include "support/solvers/device_solvers.h"

#include "pliant/solvers/iterations/lbfgs.h"
#include "support/solvers/host_device_solver.h"

namespace pliant {

template class DeviceSolver<HostExecutor>;
template class DeviceBatch<HostExecutor>;
template class BlendResidentRun<HostExecutor>;

DeviceSolverSpec device_solver_spec(const std::string& name, const StopRule& rule) {
  DeviceSolverSpec spec;
  spec.rule = rule;
  for (const char* known :
       {"jacobi", "line_search_jacobi", "gauss_seidel", "hybrid", "chebyshev", "lbfgs"}) {
    if (name == known) spec.name = known;
  }
  spec.is_accelerated = name == "chebyshev";
  spec.delay = spec.is_accelerated ? 5 : 0;
  if (name == "line_search_jacobi") spec.iteration = {DeviceIteration::kLineSearch, 2.0};
  if (name == "gauss_seidel") spec.iteration = {DeviceIteration::kSweep, 1.0, 0};
  if (name == "hybrid") spec.iteration = {DeviceIteration::kSweep, 1.0, 8};
  if (name == "lbfgs") spec = lbfgs_device_spec(rule, 5);
  return spec;
}

std::unique_ptr<Solver> make_host_device_solver(const DeviceSolverSpec& spec) {
  return std::make_unique<DeviceSolver<HostExecutor>>(
      spec, nullptr, [] { return std::make_shared<BlendResidentRun<HostExecutor>>(); });
}

std::unique_ptr<Solver> make_host_device_solver(const std::string& name, const StopRule& rule) {
  return make_host_device_solver(device_solver_spec(name, rule));
}

}  // namespace pliant
