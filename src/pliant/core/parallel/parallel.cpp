#include "pliant/core/parallel/parallel.h"

#include <pthread.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <memory>
#include <string>

#include "pliant/core/parallel/thread_team.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

// So many that one thread can take over what another one has no time for, of loops that are worth
// it.
constexpr int kPartsOfAThread = 4, kGrainsOfAThread = 4;

int thread_count = 1;
// Of the loops of libraries.
std::unique_ptr<tbb::global_control> control;
std::unique_ptr<ThreadTeam> team;

/// In a copy of the process that fork() made, which has none of the other threads: to end the team
/// would wait for them for ever.
void forget_team() {
  (void)team.release();
  thread_count = 1;
}

}  // namespace

int threads() { return thread_count; }

void set_threads(int count) {
  if (count < 1) {
    throw InputError("threads is " + std::to_string(count) + ", but must be at least 1");
  }
  control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(count));
  if (count == thread_count) return;
  static const int kept = pthread_atfork(nullptr, nullptr, forget_team);
  (void)kept;
  team = count > 1 ? std::make_unique<ThreadTeam>(count) : nullptr;
  thread_count = count;
}

int usual_threads() { return std::min(2, tbb::info::default_concurrency()); }

bool has_free_threads() { return thread_count > 1 && !team->has_job(); }

namespace parallel_detail {

bool run_parts(int parts, void (*call)(const void*, int), const void* context) {
  return team->run(parts, call, context);
}

int count_parts(int size, int grain) {
  const int grains = size / grain + (size % grain == 0 ? 0 : 1);
  const bool is_long = grains / kGrainsOfAThread >= thread_count;
  const int most = (is_long ? kPartsOfAThread : 1) * thread_count;
  return std::clamp(grains, 1, std::min(most, ThreadTeam::kMostParts));
}

}  // namespace parallel_detail
}  // namespace pliant
