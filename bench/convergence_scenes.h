#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pliant/core/world.h"

namespace pliant::bench {

/// A world in mid-motion, one step of which is solved again and again.
struct ConvergenceScene {
  std::string name;
  std::function<std::unique_ptr<World>()> make;  ///< with effects, without a solver
  int settling_steps = 20;                       ///< before the step that is measured
};

/// Soft to stiff, coarse to fine, slivers, contact: cloths and solids.
std::vector<ConvergenceScene> convergence_scenes();

}  // namespace pliant::bench
