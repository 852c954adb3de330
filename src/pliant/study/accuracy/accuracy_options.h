#pragma once

#include <optional>
#include <string>
#include <vector>

namespace pliant {

/// What a user asks an accuracy study for.
struct AccuracyOptions {
  std::vector<std::string> solvers;  ///< empty: all that suit the scene's models
  std::vector<int> iterations = {1, 2, 4, 8, 16, 32, 64, 128, 256};
  std::vector<double> time_steps;              ///< of whole runs [s]; empty: no whole runs
  std::vector<std::string> time_integrations;  ///< of whole runs; empty: the scene's
  std::optional<double> duration;              ///< simulated [s]; 1 s unless this or `steps` says
  std::optional<double> steps;                 ///< of the scene's own time step
  int samples = 5;                             ///< states whose next step is measured
  int repeats = 5;                             ///< of a step, whose median time is taken
  std::vector<std::string> references;         ///< up to two solvers; the missing ones are chosen
};

}  // namespace pliant
