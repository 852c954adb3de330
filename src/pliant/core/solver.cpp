#include "pliant/core/solver.h"

namespace pliant {

std::vector<ParameterSpec> stop_rule_parameters(const std::string& default_iterations) {
  return {
      integer_parameter("iterations", default_iterations, 0, 1e6,
                        "most iterations in one time step"),
      number_parameter("tolerance", "", "0", 0.0, 1.0,
                       "stop when less than this share of the forces is out of balance (relative "
                       "residual); 0 never"),
      number_parameter("budget", "ms", "0", 0.0, 1e6,
                       "stop after this wall time; 0 never; results then depend on the machine"),
      number_parameter("error", "", "0", 0.0, 1.0,
                       "iterate until the estimated error of the step is below this share of what "
                       "the step's forces move, however many of the 'iterations' that takes; 0 "
                       "never")};
}

StopRule stop_rule(const Parameters& parameters) {
  return {parameters.integer("iterations"), parameters.number("tolerance"),
          1e-3 * parameters.number("budget"), parameters.number("error")};
}

}  // namespace pliant
