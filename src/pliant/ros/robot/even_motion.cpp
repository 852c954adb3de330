#include "pliant/ros/robot/even_motion.h"

#include <algorithm>

namespace pliant {

void EvenMotion::start(double time) {
  if (last_message_ < 0.0) {
    period_ = kMaxPeriod;
  } else {
    // Messages that come in a bunch must not make things jump.
    period_ = std::clamp(time - last_message_, 0.5 * period_, kMaxPeriod);
  }
  last_message_ = time;
  motion_start_ = last_time_;
}

double EvenMotion::share(double time) const {
  return std::clamp((time - motion_start_) / period_, 0.0, 1.0);
}

void EvenMotion::end_step(double time) {
  if (restarts(time)) last_message_ = -1.0;
  last_time_ = time;
}

}  // namespace pliant
