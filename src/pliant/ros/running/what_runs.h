#pragma once

#include <string>
#include <vector>

#include "pliant/ros/running/simulation.h"

namespace pliant {

/// What a node says at its start: its scene, each body with what moves it where, its topics, and
/// calls to try. `topics`: names of those of the scene; `node`: the node's name.
std::string what_runs(const Simulation& simulation, const std::vector<std::string>& topics,
                      const std::string& node);

}  // namespace pliant
