#pragma once

namespace pliant {

/// Runs the node `name`: loads the scene that its private parameters name, simulates and serves it
/// until it is shut down. Returns the exit code of the process: 0, or 2 for bad parameters or a bad
/// scene, which are logged as FATAL.
int run_model_node(int argc, char** argv, const char* name);

}  // namespace pliant
