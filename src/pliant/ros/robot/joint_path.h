#pragma once

#include <deque>
#include <vector>

#include "pliant/ros/robot/played_stamp.h"

namespace pliant {

/// Where joints are between messages whose stamps are simulated times: on straight lines between
/// what the messages say, at their stamps, played a little later (PlayedStamp).
class JointPath {
 public:
  explicit JointPath(std::size_t joints) : knots_(joints) {}

  /// Takes a position over that was sent at the simulated time `stamp` and met in the step to
  /// `time` [s]. Returns whether it begins a path of the joint.
  bool add(std::size_t joint, double stamp, double position, double time);
  /// Begins a step to `time`: finds which stamp is played in it.
  void play(double time);
  /// At the stamp that is played, of a joint that has been added.
  double position(std::size_t joint) const;
  void clear();

  double delay() const { return played_.delay(); }  ///< from a stamp to when it is played [s]

 private:
  struct Knot {
    double stamp, position;
  };

  std::vector<std::deque<Knot>> knots_;  // of each joint, by stamp
  PlayedStamp played_;
};

}  // namespace pliant
