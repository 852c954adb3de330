#include "pliant/ros/robot/joint_path.h"

namespace pliant {

bool JointPath::add(std::size_t joint, double stamp, double position, double time) {
  std::deque<Knot>& knots = knots_[joint];
  if (!knots.empty() && stamp == knots.back().stamp) {
    knots.back().position = position;
    return false;
  }
  bool begins = knots.empty();
  if (begins) {
    played_.begin(stamp, time);
  } else {
    begins = played_.follow(knots.back().stamp, stamp, time);
  }
  if (begins) knots.clear();
  knots.push_back({stamp, position});
  return begins;
}

void JointPath::play(double time) {
  played_.play(time);
  for (std::deque<Knot>& knots : knots_) {
    while (knots.size() > 1 && knots[1].stamp <= played_.stamp()) knots.pop_front();
  }
}

double JointPath::position(std::size_t joint) const {
  const std::deque<Knot>& knots = knots_[joint];
  const Knot& from = knots.front();
  if (knots.size() == 1 || played_.stamp() <= from.stamp) return from.position;
  const Knot& to = knots[1];
  const double share = (played_.stamp() - from.stamp) / (to.stamp - from.stamp);
  return from.position + share * (to.position - from.position);
}

void JointPath::clear() {
  for (std::deque<Knot>& knots : knots_) knots.clear();
  played_.clear();
}

}  // namespace pliant
