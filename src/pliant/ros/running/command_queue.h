#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace pliant {

/// What a request came to.
struct Answer {
  bool success = false;
  std::string message;
  double sim_time = 0.0;  ///< afterwards [s]
};

/// Where the simulation thread puts the answer to a request, now or some steps later.
using Reply = std::shared_ptr<std::promise<Answer>>;

/// Carries requests from service callbacks to the simulation thread. Waits on the steady clock
/// only, never on ROS time, which may stand still.
class CommandQueue {
 public:
  using Command = std::function<void(const Reply&)>;
  using Clock = std::chrono::steady_clock;

  /// Hands `command` over and waits for its answer. Thread-safe. The answer says so when the queue
  /// is closed.
  Answer call(Command command);

  /// Runs the commands that are there; costs one atomic read when there are none. What a command
  /// throws becomes its answer. Called by the simulation thread only.
  void run_pending();
  /// Returns when a command comes, the queue is closed, or at `time`.
  void wait_until(Clock::time_point time);

  /// Refuses all commands from now on, those that wait included. Thread-safe.
  void close();
  bool closed() const { return closed_; }

 private:
  struct Entry {
    Command command;
    Reply reply;
  };

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Entry> entries_;
  std::atomic<bool> pending_{false};
  std::atomic<bool> closed_{false};
};

}  // namespace pliant
