#pragma once

#include <string_view>

#include "pliant/core/registry.h"
#include "pliant/core/step_report.h"
#include "pliant/core/system.h"

namespace pliant {

/// When an iterative solver stops: whichever rule is met first.
struct StopRule {
  int iterations = 10;
  double tolerance = 0.0;  ///< of the relative residual; 0 switches the rule off
  double budget = 0.0;     ///< wall time of the iterations [s]; 0 switches the rule off
};

/// The three stop rules as parameters, and back.
std::vector<ParameterSpec> stop_rule_parameters(const std::string& default_iterations);
StopRule stop_rule(const Parameters& parameters);

/// Advances a system by one time step; knows no model. It keeps nothing that a swap would lose:
/// positions and velocities live in the system.
class Solver {
 public:
  virtual ~Solver() = default;
  virtual std::string_view name() const = 0;
  /// The system's structure (elements, masses, fixed particles) or the time step changed.
  virtual void prepare(System& system, double dt) = 0;
  virtual void step(System& system, double dt, StepReport& report) = 0;
};

using SolverRegistry = Registry<Solver>;

}  // namespace pliant
