#pragma once

#include <functional>
#include <string>

namespace pliant {

struct ExperimentOptions {
  std::string folder;  ///< for the tables; it exists
  double share = 1.0;  ///< of the experiment's sizes and steps, in (0, 1]
  std::string figure;  ///< a file of a closed mesh, for those with a figure
};

/// Told how much of an experiment is done, in [0, 1]; false asks it to stop.
using ExperimentProgress = std::function<bool(double done, const std::string& what)>;

/// One of a study's experiments. `run` writes its tables and returns false when it was asked to
/// stop.
struct Experiment {
  std::string name, meaning;
  bool (*run)(const ExperimentOptions& options, const ExperimentProgress& progress);
};

}  // namespace pliant
