#pragma once

namespace pliant {

/// Which stamp of a stream of messages is played in a step, where stamps are simulated times: the
/// step's time less a delay, as long as the slowest message of the last seconds needed. So what
/// moves between messages does so as its sender moved it, however unevenly they come.
class PlayedStamp {
 public:
  /// A message that is later than the one before it by more begins anew [s].
  static constexpr double kMaxPeriod = 0.2;

  /// Whether a stamp can be of the simulated time that a message of it is met at [s].
  static bool is_simulated(double stamp, double time) {
    return stamp <= time + kEarly && stamp >= time - kLate;
  }

  /// A message with `stamp` is met in the step to `time` [s] after one with `last`. Returns whether
  /// it begins anew: that one lies long ago, was played to its end, or is later.
  bool follow(double last, double stamp, double time);
  /// The first message.
  void begin(double stamp, double time) { need(time - stamp, time); }
  /// Begins a step to `time` [s].
  void play(double time);
  double stamp() const { return stamp_; }  ///< that is played [s]; never goes back
  double delay() const { return delay_; }  ///< [s]
  void clear() { *this = PlayedStamp(); }

 private:
  static constexpr double kLate = 1.0, kEarly = 1e-6;  // [s]
  void need(double delay, double time);

  double stamp_ = 0.0;  // [s]
  bool is_playing_ = false;
  double last_time_ = 0.0;                     // of the last step [s]
  double delay_ = 0.0;                         // [s]
  double needed_ = 0.0, needed_before_ = 0.0;  // most in this window and in the one before [s]
  double window_end_ = 0.0;                    // [s]
};

}  // namespace pliant
