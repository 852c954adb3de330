#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <pliant/SolverStatus.h>

#include <string>
#include <vector>

#include "pliant/ros/running/simulation.h"
#include "pliant/ros/running/step_statistics.h"

namespace pliant {

/// All of `status` but its header.
void fill_status(const Simulation& simulation, const StepStatistics& statistics,
                 SolverStatus& status);

/// ERROR when a step was undone, WARN with the steps' warnings, else OK: of the simulation and, of
/// several bodies, of each. Then what stays: WARN of what is odd in the scene and in the motion of
/// its robots, and of what is wrong around the node. `node`: its name.
void fill_diagnostics(const Simulation& simulation, const StepStatistics& statistics,
                      const std::string& node,
                      std::vector<diagnostic_msgs::DiagnosticStatus>& statuses);

}  // namespace pliant
