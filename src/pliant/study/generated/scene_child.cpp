#include "pliant/study/generated/scene_child.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace pliant {
namespace {

void limit(__rlimit_resource_t resource, rlim_t most) {
  const rlimit limits{most, most};
  setrlimit(resource, &limits);
}

std::string text_of(const SceneOutcome& outcome) {
  return fmt::format("{} {:.17g} {:.17g} {}\n{}", static_cast<int>(outcome.fate), outcome.energy,
                     outcome.seconds, outcome.oracle, outcome.message);
}

SceneOutcome outcome_of(const std::string& text) {
  SceneOutcome outcome;
  int fate = 0;
  std::istringstream in(text);
  in >> fate >> outcome.energy >> outcome.seconds;
  in.get();
  std::getline(in, outcome.oracle);
  outcome.fate = static_cast<SceneFate>(fate);
  std::getline(in, outcome.message, '\0');
  return outcome;
}

[[noreturn]] void run_child(const SceneChoice& choice, const std::string& robot, int descriptor) {
  limit(RLIMIT_CPU, SceneChild::kMostSeconds);
  limit(RLIMIT_CORE, 0);
  const std::string text = text_of(try_scene(choice, robot, SceneCare::kThorough));
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t count = write(descriptor, text.data() + sent, text.size() - sent);
    if (count <= 0) _exit(1);
    sent += static_cast<std::size_t>(count);
  }
  _exit(0);
}

std::string end_of(int status) {
  if (!WIFSIGNALED(status))
    return fmt::format("its process ended with code {}", WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU || signal == SIGKILL) {
    return fmt::format("it took more than {} s", SceneChild::kMostSeconds);
  }
  return fmt::format("its process was ended by {}", strsignal(signal));
}

}  // namespace

SceneChild::SceneChild(int index, const SceneChoice& choice, const std::string& robot)
    : index_(index) {
  int ends[2];
  if (pipe(ends) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  process_ = fork();
  if (process_ == 0) {
    close(ends[0]);
    run_child(choice, robot, ends[1]);
  }
  close(ends[1]);
  descriptor_ = ends[0];
  if (process_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
}

SceneChild::~SceneChild() {
  if (descriptor_ >= 0) close(descriptor_);
  if (process_ <= 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

std::optional<SceneOutcome> SceneChild::read() {
  char buffer[4096];
  const ssize_t count = ::read(descriptor_, buffer, sizeof buffer);
  if (count < 0 && errno == EINTR) return std::nullopt;
  if (count > 0) {
    text_.append(buffer, static_cast<std::size_t>(count));
    return std::nullopt;
  }
  int status = 0;
  waitpid(process_, &status, 0);
  process_ = -1;
  if (status == 0) return outcome_of(text_);
  return SceneOutcome{SceneFate::kFailed, "died", end_of(status), 0.0, 0.0};
}

}  // namespace pliant
