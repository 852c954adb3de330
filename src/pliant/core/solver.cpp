#include "pliant/core/solver.h"

#include <algorithm>

#include "pliant/math/error.h"

namespace pliant {

std::vector<ParameterSpec> stop_rule_parameters(const std::string& default_iterations) {
  return {
      integer_parameter("iterations", default_iterations, 0, 1e6,
                        "most iterations in one time step"),
      number_parameter("tolerance", "", "0", 0.0, 1.0,
                       "stop once each body's forces balance to this share; 0 never"),
      number_parameter("budget", "ms", "0", 0.0, 1e6,
                       "stop after this wall time; 0 never; results then depend on the machine"),
      number_parameter("error", "", "0", 0.0, 1.0,
                       "adapt 'iterations' from step to step so that the estimated distance from "
                       "where the body should be stays below this share of its displacement; on "
                       "the CPU; 0 keeps them"),
      integer_parameter("most_iterations", "20000", 1, 1e6,
                        "most iterations in one time step where 'error' sets them")};
}

StopRule stop_rule(const Parameters& parameters) {
  StopRule rule = {parameters.integer("iterations"), parameters.number("tolerance"),
                   1e-3 * parameters.number("budget"), parameters.number("error"),
                   parameters.integer("most_iterations")};
  if (rule.error == 0.0 && rule.most_iterations != StopRule().most_iterations) {
    throw InputError(
        "'most_iterations' bounds the iterations that an asked 'error' takes, and none is asked "
        "for: give 'error' too, or 'iterations' alone");
  }
  if (rule.error > 0.0) rule.iterations = std::min(rule.iterations, rule.most_iterations);
  return rule;
}

}  // namespace pliant
