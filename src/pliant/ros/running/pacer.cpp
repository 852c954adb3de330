#include "pliant/ros/running/pacer.h"

#include <cmath>

namespace pliant {
namespace {

constexpr auto kMaxLag = std::chrono::milliseconds(100);

}  // namespace

void Pacer::restart(double time) {
  start_ = Clock::now();
  start_time_ = time;
}

Pacer::Clock::time_point Pacer::due(double time) {
  if (std::isinf(limit_)) return Clock::time_point::min();
  const std::chrono::duration<double> wall((time - start_time_) / limit_);
  const Clock::time_point due = start_ + std::chrono::duration_cast<Clock::duration>(wall);
  if (due + kMaxLag < Clock::now()) restart(time);
  return due;
}

}  // namespace pliant
