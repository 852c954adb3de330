#include "pliant/app/commands/script_commands.h"

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

[[noreturn]] void run_script(const std::string& name, std::vector<std::string> arguments) {
  const std::string script = find_shared("scripts/" + name);
  if (script.empty()) {
    throw InputError(name + ": scripts/" + name +
                     " is neither in Pliant's sources nor where it is installed");
  }
  arguments.insert(arguments.begin(), script);
  std::vector<char*> texts;
  for (std::string& argument : arguments) texts.push_back(argument.data());
  texts.push_back(nullptr);
  // Its scenes are run by this very program.
  std::error_code ignored;
  const std::string self = std::filesystem::read_symlink("/proc/self/exe", ignored).string();
  setenv("PLIANT_PROGRAM", self.c_str(), 1);
  execv(script.c_str(), texts.data());
  throw InputError(name + ": cannot start " + script + ": " + std::strerror(errno));
}

void add_script(CLI::App& app, const std::string& name, const std::string& description) {
  CLI::App* command = app.add_subcommand(name, description);
  // All that follows is the script's, --help too.
  command->set_help_flag();
  command->prefix_command();
  command->callback([command, name] { run_script(name, command->remaining()); });
}

}  // namespace

void add_script_commands(CLI::App& app) {
  add_script(app, "sweep", "Run the scenes of a table in shards, on many processors or machines");
  add_script(app, "identify",
             "Find numbers of a scene with which it moves as measured: material, friction, air");
}

}  // namespace pliant
