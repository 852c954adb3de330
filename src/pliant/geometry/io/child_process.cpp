#include "pliant/geometry/io/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <mutex>
#include <new>

#include "pliant/math/error.h"

namespace pliant {
namespace {

// The first byte of what a child says.
constexpr char kDone = 'd', kRefused = 'r', kNoMemory = 'm';

/// `more`: beyond the limit by so much, the kernel kills without a word of what was exceeded.
void limit(int resource, double most, rlim_t more = 0) {
  struct rlimit both = {};
  getrlimit(static_cast<__rlimit_resource_t>(resource), &both);
  const auto wanted = static_cast<rlim_t>(most);
  both.rlim_cur = std::min(both.rlim_max, wanted);  // RLIM_INFINITY is the largest number
  both.rlim_max = std::min(both.rlim_max, wanted + more);
  setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

double bytes_of_this_process() {
  double pages = 0.0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void say(int pipe, char kind, const std::string& text) {
  const std::string all = kind + text;
  for (std::size_t done = 0; done < all.size();) {
    const ssize_t now = write(pipe, all.data() + done, all.size() - done);
    if (now < 0 && errno != EINTR) _exit(1);
    if (now > 0) done += static_cast<std::size_t>(now);
  }
}

/// In the child. What the program does at its end is not for a copy of it: _exit().
[[noreturn]] void work_in_child(const ChildLimits& limits, double own_bytes, int pipe,
                                const std::function<std::string()>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU, SIGTERM}) {
    std::signal(signal, SIG_DFL);
  }
  limit(RLIMIT_CORE, 0.0);
  limit(RLIMIT_FSIZE, 0.0);
  limit(RLIMIT_AS, own_bytes + limits.memory);
  limit(RLIMIT_CPU, limits.seconds, 1);
  const int nothing = open("/dev/null", O_RDWR);
  dup2(nothing, STDERR_FILENO);  // a dying library's words; why it died is told by the parent
  try {
    say(pipe, kDone, work());
  } catch (const InputError& error) {
    say(pipe, kRefused, error.what());
  } catch (const std::bad_alloc&) {
    say(pipe, kNoMemory, "");
  } catch (...) {
    _exit(1);
  }
  _exit(0);
}

/// All that comes until the child closes its end; whether it did so in time.
bool listen(int pipe, int seconds, std::string& heard) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(seconds);
  std::string block(1 << 16, '\0');
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    struct pollfd one = {pipe, POLLIN, 0};
    const int ready = poll(&one, 1, left > 0 ? static_cast<int>(left) : 0);
    if (ready == 0) return false;
    const ssize_t now = ready < 0 ? -1 : read(pipe, block.data(), block.size());
    if (now == 0) return true;
    if (now < 0 && errno != EINTR) return false;
    if (now > 0) heard.append(block, 0, static_cast<std::size_t>(now));
  }
}

std::string why_it_ended(int status, bool in_time, const ChildLimits& limits) {
  if (!in_time || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)) {
    return fmt::format("its reader took more than {} s", limits.seconds);
  }
  return WIFSIGNALED(status) ? fmt::format("its reader crashed ({})", strsignal(WTERMSIG(status)))
                             : "its reader gave up";
}

}  // namespace

std::string in_child_process(const ChildLimits& limits, const std::string& what,
                             const std::function<std::string()>& work) {
  // A library's own locks would stay locked in a copy that is made while another thread is in it:
  // all that use one come through here, and wait for each other to have made theirs.
  static std::mutex mutex;
  int ends[2];
  pid_t child = -1;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    const double own_bytes = bytes_of_this_process();
    if (pipe2(ends, O_CLOEXEC) != 0) {
      throw InputError(fmt::format("{}: cannot be read: {}", what, std::strerror(errno)));
    }
    child = fork();
    if (child == 0) work_in_child(limits, own_bytes, ends[1], work);
  }
  const int why = errno;
  close(ends[1]);
  std::string heard;
  const bool in_time = child > 0 && listen(ends[0], 2 * limits.seconds, heard);
  close(ends[0]);
  if (child < 0) throw InputError(fmt::format("{}: cannot be read: {}", what, std::strerror(why)));
  if (!in_time) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const char kind = heard.empty() ? '\0' : heard.front();
  if (kind == kDone && in_time && !WIFSIGNALED(status)) return heard.substr(1);
  if (kind == kRefused) throw InputError(heard.substr(1));
  throw InputError(fmt::format("{}: cannot be read: {}", what,
                               kind == kNoMemory
                                   ? fmt::format("it takes more than {:g} GB", 1e-9 * limits.memory)
                                   : why_it_ended(status, in_time, limits)));
}

}  // namespace pliant
