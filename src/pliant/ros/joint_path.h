#pragma once

#include <deque>
#include <vector>

namespace pliant {

/// Where joints are between messages whose stamps are simulated times: on straight lines between
/// what the messages say, at their stamps. So they move as their sender moves them, however
/// unevenly the messages arrive. That asks for the message after next: all is played later by a
/// delay, which is as long as the slowest message of the last seconds needed.
class JointPath {
 public:
  /// A message whose stamp is later than that of the one before by more begins a new path [s].
  static constexpr double kMaxPeriod = 0.2;

  explicit JointPath(std::size_t joints) : knots_(joints) {}

  /// Takes a position over that was sent at the simulated time `stamp` and met in the step to
  /// `time` [s]. Returns whether it begins a path of the joint: the one before it lies long ago,
  /// was played to its end, or is later.
  bool add(std::size_t joint, double stamp, double position, double time);
  /// Begins a step to `time`: finds which stamp is played in it.
  void play(double time);
  /// At the stamp that is played, of a joint that has been added.
  double position(std::size_t joint) const;
  void clear();

  double delay() const { return delay_; }  ///< between a stamp and the time it is played at [s]

 private:
  struct Knot {
    double stamp, position;
  };
  void need(double delay, double time);

  std::vector<std::deque<Knot>> knots_;  // of each joint, by stamp
  double played_ = 0.0;                  // stamp [s]; never goes back
  bool is_playing_ = false;
  double last_time_ = 0.0;                     // of the last step [s]
  double delay_ = 0.0;                         // [s]
  double needed_ = 0.0, needed_before_ = 0.0;  // most in this window and in the one before [s]
  double window_end_ = 0.0;                    // [s]
};

}  // namespace pliant
