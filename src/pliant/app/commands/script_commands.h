#pragma once

#include <CLI/CLI.hpp>

namespace pliant {

/// The subcommands `sweep` and `identify`: scripts of these names in scripts/, which take the place
/// of this process.
void add_script_commands(CLI::App& app);

}  // namespace pliant
