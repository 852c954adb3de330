#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>

#include "pliant/app/commands/commands.h"
#include "pliant/app/commands/script_commands.h"
#include "pliant/math/error.h"
#include "pliant/math/version.h"
#include "pliant/scene/extensions.h"

namespace pliant {
namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 done; 1 internal error; 2 bad input (arguments, a scene, a file);\n"
    "            3 the simulation was no longer finite (of a batch: a scene stopped or was\n"
    "            refused); 4 nothing fits (study advise);\n"
    "            130 interrupted";

void finish_app(CLI::App& app) {
  app.set_version_flag("--version", std::string("pliant ") + kVersion, "Print the version");
  app.footer(kExitCodes);
}

int run(int argc, char** argv) {
  CLI::App app("Pliant: a solver framework for deformable objects", "pliant");
  finish_app(app);
  app.require_subcommand(0, 1);  // 1 would hide which word is no subcommand
  int exit_code = kOk;
  add_check_command(app, exit_code);
  add_run_command(app, exit_code);
  add_describe_command(app, exit_code);
  add_list_command(app, exit_code);
  add_collider_command(app, exit_code);
  add_fit_command(app, exit_code);
  add_study_command(app, exit_code);
  add_script_commands(app);
  add_reduce_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kBadInput;
  }
  if (app.get_subcommands().empty()) {
    std::cerr << app.help();
    return kBadInput;
  }
  return exit_code;
}

/// What was printed may not have arrived: on a full disk, say.
int flushed(int exit_code) {
  std::cout.flush();
  const bool arrived = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
  if (arrived || exit_code != kOk) return exit_code;
  throw InputError("cannot write to standard output: is the disk full?");
}

}  // namespace

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description) {
  CLI::App* command = app.add_subcommand(name, description);
  finish_app(*command);
  return command;
}

}  // namespace pliant

int main(int argc, char** argv) {
  // A file that grows beyond `ulimit -f` is an error as a full disk is, not the program's end.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    pliant::load_extensions_of_environment();
    return pliant::flushed(pliant::run(argc, argv));
  } catch (const pliant::InputError& error) {
    std::cerr << "error: " << error.what() << std::endl;
    return pliant::kBadInput;
  } catch (const std::bad_alloc&) {
    std::cerr << "error: there is not enough memory for this scene" << std::endl;
    return pliant::kBadInput;
  } catch (const std::exception& error) {
    // The library that prints throws a system error of its own.
    if (std::ferror(stdout) != 0) {
      std::cerr << "error: cannot write to standard output: " << error.what() << std::endl;
      return pliant::kBadInput;
    }
    std::cerr << "internal error: " << error.what() << std::endl;
    return pliant::kInternalError;
  }
}
