#include "pliant/app/commands/sweep_command.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "pliant/app/plot.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

[[noreturn]] void run_sweep(std::vector<std::string> arguments) {
  const std::string script = find_shared("scripts/sweep");
  if (script.empty()) {
    throw InputError(
        "sweep: scripts/sweep is neither in Pliant's sources nor where it is installed");
  }
  arguments.insert(arguments.begin(), script);
  std::vector<char*> texts;
  for (std::string& argument : arguments) texts.push_back(argument.data());
  texts.push_back(nullptr);
  // Its shards are run by this very program.
  std::error_code ignored;
  const std::string self = std::filesystem::read_symlink("/proc/self/exe", ignored).string();
  setenv("PLIANT_PROGRAM", self.c_str(), 1);
  execv(script.c_str(), texts.data());
  throw InputError("sweep: cannot start " + script + ": " + std::strerror(errno));
}

}  // namespace

void add_sweep_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "sweep", "Run the scenes of a table in shards, on many processors or machines");
  // All that follows is the script's, --help too.
  command->set_help_flag();
  command->prefix_command();
  command->callback([command] {
    std::vector<std::string> arguments = command->remaining();
    run_sweep(std::move(arguments));
  });
}

}  // namespace pliant
