#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

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

/// In a child: signals end or interrupt it as from a terminal, also where the tests run under nohup
/// or in the background of a shell, whose children ignore some.
inline void take_signals() {
  for (const int signal : {SIGHUP, SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
}

/// Runs the program, sends it `signal` as soon as `condition()` holds, and waits for its end; the
/// code is negative where a signal ended it, or when the condition did not hold within a minute.
template <class Condition>
Outcome run_until(const std::vector<std::string>& arguments, const std::string& output, int signal,
                  const Condition& condition) {
  const pid_t child = fork();
  if (child == 0) {
    take_signals();
    const int file = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    std::vector<char*> words = {const_cast<char*>(kProgram.c_str())};
    for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    execv(kProgram.c_str(), words.data());
    _exit(127);
  }
  int status = 0, done = 0;
  for (int n = 0; n < 60000 && done == 0 && !condition(); ++n) {
    usleep(1000);
    done = waitpid(child, &status, WNOHANG);
  }
  if (done == 0) {
    kill(child, condition() ? signal : SIGKILL);
    waitpid(child, &status, 0);
  }
  std::ostringstream text;
  text << std::ifstream(output).rdbuf();
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), text.str()};
}

inline std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

inline bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace pliant
