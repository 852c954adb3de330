#pragma once

#include <limits>

namespace pliant {

/// How far a sender of messages with simulated stamps is behind the simulation whose /clock it
/// follows. A simulation that goes on without it would move robots another way on each run: as late
/// as the machine made the sender.
class SenderLag {
 public:
  /// A message was met that is of the simulated time `stamp` [s].
  void add(double stamp);
  /// Whether a simulation at `time` [s] has to wait for a message, where `newest` [s] is the stamp
  /// of the last that came: that is more than two of the sender's periods before. Never of a sender
  /// that has stopped, or that rests between messages.
  bool is_long(double time, double newest) const;
  bool is_long(double time) const { return is_long(time, newest_); }
  /// It was waited for in vain: nobody waits for it any more until it sends again.
  void give_up() { has_stopped_ = true; }
  bool has_stopped() const { return has_stopped_; }
  double newest() const { return newest_; }  ///< stamp [s]; -infinity before the first

  static constexpr double kMostPeriod = 0.4;  ///< longer ones are rests [s]

 private:
  // That is guessed [s]: messages that are no further apart are played one after the other
  // (PlayedStamp::kMaxPeriod).
  static constexpr double kFirstPeriod = 0.08;
  void learn_period(double period);

  double newest_ = -std::numeric_limits<double>::infinity();  // [s]
  double period_ = kFirstPeriod;                              // [s]; infinite: it rests
  bool has_stopped_ = false;
};

}  // namespace pliant
