#include "pliant/study/step_times.h"

#include <time.h>

#include <algorithm>
#include <numeric>

#include "pliant/core/timer.h"

namespace pliant {
namespace {

double processor_time() {
  timespec now = {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

bool StepTimes::step(World& world, bool is_timed) {
  const double processor = processor_time();
  const Timer timer;
  const bool is_finite = world.step();
  if (is_timed) {
    wall_.push_back(timer.seconds());
    processor_.push_back(processor_time() - processor);
  }
  return is_finite;
}

double StepTimes::median_wall() const { return median(wall_); }

double StepTimes::median_processor() const { return median(processor_); }

double StepTimes::longest_wall() const {
  return wall_.empty() ? 0.0 : *std::max_element(wall_.begin(), wall_.end());
}

double StepTimes::total_wall() const { return std::accumulate(wall_.begin(), wall_.end(), 0.0); }

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + (static_cast<std::ptrdiff_t>(values.size()) - 1) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace pliant
