#include "pliant/ros/joint_path.h"

#include <algorithm>

namespace pliant {
namespace {

constexpr double kWindow = 2.0;     // in which the slowest message counts [s]
constexpr double kHurry = 0.02;     // by which joints are faster while the delay shrinks
constexpr double kMostDelay = 0.5;  // [s]

}  // namespace

void JointPath::need(double delay, double time) {
  if (time >= window_end_) {
    needed_before_ = needed_;
    needed_ = 0.0;
    window_end_ = time + kWindow;
  }
  needed_ = std::max(needed_, std::min(delay, kMostDelay));
  delay_ = std::max(delay_, needed_);
}

bool JointPath::add(std::size_t joint, double stamp, double position, double time) {
  std::deque<Knot>& knots = knots_[joint];
  if (!knots.empty() && stamp == knots.back().stamp) {
    knots.back().position = position;
    return false;
  }
  const bool follows =
      !knots.empty() && stamp > knots.back().stamp && stamp <= knots.back().stamp + kMaxPeriod;
  // Until this message came the one before it had to last.
  need(time - (follows ? knots.back().stamp : stamp), time);
  // If that was played to its end, the joint stood still.
  const bool begins = !follows || (is_playing_ && knots.back().stamp < played_);
  if (begins) knots.clear();
  knots.push_back({stamp, position});
  return begins;
}

void JointPath::play(double time) {
  const double step = time - last_time_;
  last_time_ = time;
  const double needed = std::max(needed_, needed_before_);
  if (delay_ > needed) delay_ = std::max(needed, delay_ - kHurry * step);
  played_ = is_playing_ ? std::max(played_, time - delay_) : time - delay_;
  is_playing_ = true;
  for (std::deque<Knot>& knots : knots_) {
    while (knots.size() > 1 && knots[1].stamp <= played_) knots.pop_front();
  }
}

double JointPath::position(std::size_t joint) const {
  const std::deque<Knot>& knots = knots_[joint];
  const Knot& from = knots.front();
  if (knots.size() == 1 || played_ <= from.stamp) return from.position;
  const Knot& to = knots[1];
  const double share = (played_ - from.stamp) / (to.stamp - from.stamp);
  return from.position + share * (to.position - from.position);
}

void JointPath::clear() {
  for (std::deque<Knot>& knots : knots_) knots.clear();
  is_playing_ = false;
  delay_ = needed_ = needed_before_ = window_end_ = 0.0;
}

}  // namespace pliant
