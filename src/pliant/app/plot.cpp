#include "pliant/app/plot.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <iostream>

namespace pliant {
namespace {

namespace fs = std::filesystem;

/// Exit code of a program that ran; -1 when it could not be started or was killed.
int run_program(std::string program, std::string argument) {
  char* arguments[] = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  if (posix_spawn(&child, program.c_str(), nullptr, nullptr, arguments, environ) != 0) return -1;
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return -1;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool plot(const std::string& name, const std::string& folder) {
  const std::string script = find_shared("scripts/" + name);
  if (script.empty()) {
    std::cerr << "no picture: scripts/" << name << " of Pliant's sources is not here; run it on "
              << folder << "\n";
    return false;
  }
  if (run_program(script, folder) == 0) return true;
  // Beginning with what the script itself said on stderr.
  std::cerr << "no picture: once that is cured, run " << script << " " << folder << "\n";
  return false;
}

}  // namespace

std::string find_shared(const std::string& file) {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& folder :
       {program / "..", fs::path(PLIANT_SCRIPTS_DIR) / "..", program / "../share/pliant"}) {
    const fs::path found = folder / file;
    if (fs::is_regular_file(found, ignored)) return found.lexically_normal().string();
  }
  return {};
}

bool plot_accuracy(const std::string& folder) { return plot("plot_accuracy", folder); }
bool plot_reduced(const std::string& folder) { return plot("plot_reduced", folder); }
bool plot_viscoelastic(const std::string& folder) { return plot("plot_viscoelastic", folder); }
bool plot_cloth(const std::string& folder) { return plot("plot_cloth", folder); }
bool plot_judges(const std::string& folder) { return plot("plot_judges", folder); }

}  // namespace pliant
