#include "pliant/core/parallel/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <memory>
#include <string>

#include "pliant/math/error.h"

namespace pliant {
namespace {
int thread_count = 1;
std::unique_ptr<tbb::global_control> control;
}  // namespace

int threads() { return thread_count; }

void set_threads(int count) {
  if (count < 1) {
    throw InputError("threads is " + std::to_string(count) + ", but must be at least 1");
  }
  control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(count));
  thread_count = count;
}

int usual_threads() { return std::min(2, tbb::info::default_concurrency()); }

}  // namespace pliant
