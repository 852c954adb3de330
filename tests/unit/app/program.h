#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

namespace pliant {

const std::string kProgram = PLIANT_PROGRAM;

struct Outcome {
  int code;
  std::string text;  ///< stdout and stderr
};

/// Runs a shell command.
inline Outcome run_command(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::string text;
  char buffer[4096];
  while (const std::size_t count = fread(buffer, 1, sizeof buffer, pipe))
    text.append(buffer, count);
  return {WEXITSTATUS(pclose(pipe)), text};
}

/// Runs the command line program.
inline Outcome run(const std::string& arguments) { return run_command(kProgram + " " + arguments); }

inline std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

inline bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace pliant
