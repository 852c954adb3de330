#pragma once

#include <string>

namespace pliant {

/// Runs the node `name`, which simulates and serves the scene that its private parameters name,
/// whatever the models of its bodies, until it is shut down. `scene_file`: what it runs without, of
/// the package's own scenes; empty: it has to be given one. Returns the exit code of the process:
/// 0, or 2 for bad parameters or a bad scene, which are logged as FATAL.
int run_model_node(int argc, char** argv, const std::string& name, const std::string& scene_file);

}  // namespace pliant
