#include "pliant/ros/robot/played_stamp.h"

#include <algorithm>

namespace pliant {
namespace {

constexpr double kWindow = 2.0;     // in which the slowest message counts [s]
constexpr double kHurry = 0.02;     // by which motions are faster while the delay shrinks
constexpr double kMostDelay = 0.5;  // [s]

}  // namespace

void PlayedStamp::need(double delay, double time) {
  if (time >= window_end_) {
    needed_before_ = needed_;
    needed_ = 0.0;
    window_end_ = time + kWindow;
  }
  needed_ = std::max(needed_, std::min(delay, kMostDelay));
  delay_ = std::max(delay_, needed_);
}

bool PlayedStamp::follow(double last, double stamp, double time) {
  const bool follows = stamp > last && stamp <= last + kMaxPeriod;
  // Until this message came the one before it had to last.
  need(time - (follows ? last : stamp), time);
  // If that was played to its end, things stood still.
  return !follows || (is_playing_ && last < stamp_);
}

void PlayedStamp::play(double time) {
  const double step = time - last_time_;
  last_time_ = time;
  const double needed = std::max(needed_, needed_before_);
  if (delay_ > needed) delay_ = std::max(needed, delay_ - kHurry * step);
  stamp_ = is_playing_ ? std::max(stamp_, time - delay_) : time - delay_;
  is_playing_ = true;
}

}  // namespace pliant
