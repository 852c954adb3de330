#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace pliant {

/// Threads that stay and take parts of one job after another. An iteration of a solver has loops of
/// ten microseconds, and a pool whose threads sleep in between takes as long to wake them: these
/// look out for the next job for a while first. A part goes to the same thread each time, whose
/// cache has what it needs, unless that thread is late and another one has nothing left.
class ThreadTeam {
 public:
  /// `threads` >= 1 in all, with the one that calls run(); the others start here.
  explicit ThreadTeam(int threads);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  static constexpr int kMostParts = 0xffff;
  /// Calls call(context, k) once for each k in [0, parts), in any order and on any thread of the
  /// team, and returns when all are done; throws what one of them threw. The calling thread takes
  /// parts itself, so that it never waits for one that sleeps. False, and nothing was called, where
  /// the team has a job already, of this thread or another one.
  bool run(int parts, void (*call)(const void* context, int part), const void* context);
  bool has_job() const { return has_job_.load(std::memory_order_relaxed); }

 private:
  /// A thread's parts of a job: the job's number, the next part and the end of them.
  struct alignas(64) Share {
    std::atomic<std::uint64_t> ticket{0};
  };
  static constexpr std::uint64_t ticket(std::uint32_t job, int next, int end) {
    return static_cast<std::uint64_t>(job) << 32 | static_cast<std::uint64_t>(end) << 16 |
           static_cast<std::uint64_t>(next);
  }
  static int end_of(std::uint64_t ticket) { return static_cast<int>(ticket >> 16 & kMostParts); }
  static int next_of(std::uint64_t ticket) { return static_cast<int>(ticket & kMostParts); }

  int size() const { return static_cast<int>(shares_.size()); }
  void publish(int parts);
  void work(int thread);
  /// One of the thread's own, or of another's once these are gone; false where there is none.
  bool take_part(int thread);
  bool take_part_of(Share& share);
  /// What the calling thread has time for; wakes the others where that takes long enough.
  void take_parts_of_sleepers();
  void call_part(int part);
  /// Whether another job than `seen` comes, or the team ends, before the time to look out is over.
  bool looks_out(std::uint32_t seen) const;
  void sleep(std::uint32_t seen);
  void wake();

  std::vector<Share> shares_;
  alignas(64) std::atomic<std::uint32_t> job_{0};
  alignas(64) std::atomic<int> done_{0};
  alignas(64) std::atomic<int> sleepers_{0};
  std::atomic<bool> has_job_{false}, ends_{false};
  // Of the job: written before its tickets, and read by those who have a part of it.
  void (*call_)(const void*, int) = nullptr;
  const void* context_ = nullptr;
  std::chrono::steady_clock::duration alone_{};
  std::exception_ptr failure_;
  std::mutex mutex_;  // of failure_, and of those that sleep
  std::condition_variable woken_;
  std::vector<std::thread> threads_;
};

}  // namespace pliant
