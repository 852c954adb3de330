#include "pliant/study/step_times.h"

#include <time.h>

#include <algorithm>
#include <numeric>

#include "pliant/core/parallel/parallel.h"
#include "pliant/core/step/timer.h"

namespace pliant {
namespace {

double processor_time() {
  timespec now = {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

bool StepTimes::step(World& world, bool is_timed) {
  const double processor_start = processor_time();
  const Timer timer;
  const bool is_finite = world.step();
  if (is_timed) {
    walls_.push_back(timer.seconds());
    const double processor = processor_time() - processor_start;
    times_.push_back(threads() == 1 ? std::min(walls_.back(), processor) : walls_.back());
  }
  return is_finite;
}

double StepTimes::median() const { return median_of(times_); }

double StepTimes::median_wall() const { return median_of(walls_); }

double StepTimes::longest() const {
  return times_.empty() ? 0.0 : *std::max_element(times_.begin(), times_.end());
}

double StepTimes::total() const { return std::accumulate(times_.begin(), times_.end(), 0.0); }

double StepTimes::total_wall() const { return std::accumulate(walls_.begin(), walls_.end(), 0.0); }

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + (static_cast<std::ptrdiff_t>(values.size()) - 1) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace pliant
