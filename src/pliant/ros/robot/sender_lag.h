#pragma once

#include <limits>

namespace pliant {

/// How far a sender of messages with simulated stamps may be behind the simulation whose /clock it
/// follows. A simulation that goes on without it would move robots another way on each run: as late
/// as the machine made the sender.
///
/// How often a sender sends is not known, and what it sends while it is raced is as far apart as
/// the simulation ran ahead of it. So the lag is found by trial: it begins with the shortest, is
/// doubled where nothing comes while the simulation waits, and halved again where something does.
class SenderLag {
 public:
  /// A message was met that is of the simulated time `stamp` [s].
  void add(double stamp);
  /// Whether a simulation at `time` [s] has to wait for a message, where `newest` [s] is the stamp
  /// of the last that came. Never of a sender that has stopped, or that rests between messages.
  bool is_long(double time, double newest) const;
  bool is_long(double time) const { return is_long(time, newest_); }
  /// A simulation begins to wait for the next message. Returns for how long at most [s of wall
  /// time].
  double begin_waiting();
  /// It waited in vain: the sender may be slower than thought, and gets longer. One that is known
  /// to send more often has stopped, and nobody waits for it any more until it sends again.
  void give_up();
  bool has_stopped() const { return has_stopped_; }
  double newest() const { return newest_; }    ///< stamp [s]; -infinity before the first
  double allowed() const { return allowed_; }  ///< the lag that is not waited for [s]

  static constexpr double kLeastLag = 0.05;       ///< not waited for: a message takes its time [s]
  static constexpr double kMostPeriod = 0.4;      ///< longer ones are rests [s]
  static constexpr double kPatience = 1.0;        ///< with a sender that was in time [wall s]
  static constexpr double kTrialPatience = 0.25;  ///< with one that never was [wall s]

 private:
  void learn(double period, bool was_waited_for);
  void shorten();
  void lengthen();

  double newest_ = -std::numeric_limits<double>::infinity();  // [s]
  double allowed_ = kLeastLag;                                // [s]; infinite: it rests
  bool is_proven_ = false;  // messages came within the allowed lag
  int short_periods_ = 0;   // on end, no longer than the allowed lag
  bool is_waited_for_ = false;
  bool has_stopped_ = false;
  int answers_ = 0;  // while waited for, since the allowed lag changed
  int answers_to_shorten_ = 1;
};

}  // namespace pliant
