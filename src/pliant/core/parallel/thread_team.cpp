#include "pliant/core/parallel/thread_team.h"

#include <utility>

namespace pliant {
namespace {

// Longer than what a solver does alone between two loops, and short beside a step.
constexpr auto kLookingOut = std::chrono::microseconds(200);
// Work done alone after which those that sleep are woken, which takes some microseconds itself.
constexpr auto kAlone = std::chrono::microseconds(60);
constexpr int kLooks = 32;  // between two looks at the clock
// Of a part that another thread has: it may wait for a processor.
constexpr int kPatience = 4096;

inline void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

}  // namespace

ThreadTeam::ThreadTeam(int threads) : shares_(static_cast<std::size_t>(threads)) {
  for (int k = 1; k < threads; ++k) threads_.emplace_back([this, k] { work(k); });
}

ThreadTeam::~ThreadTeam() {
  ends_ = true;
  wake();
  for (std::thread& thread : threads_) thread.join();
}

bool ThreadTeam::run(int parts, void (*call)(const void*, int), const void* context) {
  if (has_job_.exchange(true, std::memory_order_acquire)) return false;
  call_ = call;
  context_ = context;
  done_.store(0, std::memory_order_relaxed);
  publish(parts);
  if (sleepers_.load() > 0) {
    take_parts_of_sleepers();
  } else {
    while (take_part(0)) {
    }
  }
  for (int k = 0; done_.load(std::memory_order_acquire) < parts; ++k) {
    if (k < kPatience) {
      pause();
    } else {
      std::this_thread::yield();
    }
  }
  const std::exception_ptr failure = std::exchange(failure_, nullptr);
  has_job_.store(false, std::memory_order_release);
  if (failure) std::rethrow_exception(failure);
  return true;
}

void ThreadTeam::publish(int parts) {
  const std::uint32_t job = job_.load(std::memory_order_relaxed) + 1;
  for (int k = 0; k < size(); ++k) {
    const auto share = [&](int thread) { return parts * thread / size(); };
    shares_[static_cast<std::size_t>(k)].ticket.store(ticket(job, share(k), share(k + 1)),
                                                      std::memory_order_release);
  }
  // Before the look at who sleeps: see sleep().
  job_.store(job);
}

bool ThreadTeam::take_part(int thread) {
  for (int k = 0; k < size(); ++k) {
    if (take_part_of(shares_[static_cast<std::size_t>((thread + k) % size())])) return true;
  }
  return false;
}

bool ThreadTeam::take_part_of(Share& share) {
  std::uint64_t seen = share.ticket.load(std::memory_order_acquire);
  while (next_of(seen) < end_of(seen)) {
    // Who takes a part has one of the job whose ticket this is: it is not over before.
    if (!share.ticket.compare_exchange_weak(seen, seen + 1, std::memory_order_acq_rel)) continue;
    call_part(next_of(seen));
    return true;
  }
  return false;
}

void ThreadTeam::take_parts_of_sleepers() {
  auto last = std::chrono::steady_clock::now();
  bool sleep = true;
  while (take_part(0)) {
    if (!sleep) continue;
    const auto now = std::chrono::steady_clock::now();
    alone_ += now - last;
    last = now;
    if (alone_ < kAlone) continue;
    wake();
    alone_ = {};
    sleep = false;
  }
}

void ThreadTeam::call_part(int part) {
  try {
    call_(context_, part);
  } catch (...) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
  }
  done_.fetch_add(1, std::memory_order_release);
}

void ThreadTeam::work(int thread) {
  std::uint32_t seen = 0;
  while (!ends_) {
    if (!looks_out(seen)) {
      sleep(seen);
      continue;
    }
    seen = job_.load(std::memory_order_acquire);
    while (take_part(thread)) {
    }
  }
}

bool ThreadTeam::looks_out(std::uint32_t seen) const {
  const auto end = std::chrono::steady_clock::now() + kLookingOut;
  do {
    for (int k = 0; k < kLooks; ++k) {
      if (job_.load(std::memory_order_acquire) != seen) return true;
      pause();
    }
    if (ends_.load(std::memory_order_relaxed)) return true;
  } while (std::chrono::steady_clock::now() < end);
  return false;
}

void ThreadTeam::sleep(std::uint32_t seen) {
  std::unique_lock<std::mutex> lock(mutex_);
  // Told before the look at the job, as a job is before the look at who sleeps: one of both sees
  // the other.
  ++sleepers_;
  woken_.wait(lock, [&] { return ends_ || job_.load() != seen; });
  --sleepers_;
}

void ThreadTeam::wake() {
  {
    // None is then between its look at the job and its sleep.
    const std::lock_guard<std::mutex> lock(mutex_);
  }
  woken_.notify_all();
}

}  // namespace pliant
