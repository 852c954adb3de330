#pragma once

#include <CLI/CLI.hpp>

namespace pliant {

/// The subcommand `sweep`: scripts/sweep, which takes the place of this process.
void add_sweep_command(CLI::App& app);

}  // namespace pliant
