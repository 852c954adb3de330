#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "pliant/core/solver.h"
#include "pliant/solvers/device/device_iteration.h"
#include "pliant/solvers/device/solver_batch.h"

namespace pliant {

/// The GPU failed while it worked: out of memory, a lost device.
class DeviceFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a solver that also runs on a GPU does there.
struct DeviceSolverSpec {
  std::string_view name;  ///< of the solver
  StopRule rule;
  bool is_accelerated = false;  ///< Chebyshev's or Nesterov's; else plain Jacobi iterations
  double rho = 0.0;             ///< spectral radius; 0 estimates it
  int delay = 0;                ///< plain iterations before acceleration
  DeviceIteration iteration = {};
  std::string cpu_only = {};  ///< why its parameters leave it to the CPU; empty: they do not
};

/// `backend`: auto, cpu or cuda.
ParameterSpec backend_parameter();

/// Why no solver can run on a GPU here; empty where one can. Says what to do about it.
std::string why_no_cuda();

/// `cpu` itself for the backend "cpu". For "cuda" a solver that runs on the GPU; without a GPU, or
/// in a build without CUDA, it warns once and moves bodies by `cpu`, as it does when the GPU fails
/// during a step, with the state kept. prepare() throws InputError for a system that the GPU
/// cannot take, the first time; later, when such an effect joined, it goes on with `cpu` and warns.
/// "auto" takes the GPU where it is there, takes the system and is estimated to be faster
/// (backend_choice.h), without a warning where not; each report says why.
std::unique_ptr<Solver> make_on_backend(const std::string& backend, std::unique_ptr<Solver> cpu,
                                        const DeviceSolverSpec& spec);

/// Makes a solver on a device, in a batch unless that is null. Throws DeviceFailure.
using MakeDeviceSolver = std::function<std::unique_ptr<Solver>(SolverBatch* batch)>;

/// The solver of `make`, with `cpu` to fall back on; see make_on_backend(), which is this for CUDA.
/// `iterations` of a step, and what each of them does, for the choice of "auto".
std::unique_ptr<Solver> with_fallback(const std::string& backend, std::unique_ptr<Solver> cpu,
                                      MakeDeviceSolver make, int iterations,
                                      const DeviceIteration& iteration = {});

}  // namespace pliant
