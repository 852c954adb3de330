#pragma once

namespace pliant {

/// When a motion begins and ends whose aims come as messages: from where things are to where the
/// newest message wants them, over the simulated time that lay between the last two messages (at
/// most kMaxPeriod, at least half of what it was before). Asked once a step.
class EvenMotion {
 public:
  static constexpr double kMaxPeriod = 0.2;  ///< [s]

  /// Whether a step to `time` [s] begins a run: then all jump to their aims.
  bool restarts(double time) const { return time == 0.0 || time < last_time_; }
  /// A newer message was met in the step to `time`. Motion begins where the last step ended, so
  /// that it shows in the step that runs.
  void start(double time);
  /// How much of the motion is made at `time`, 0 to 1.
  double share(double time) const;
  /// Ends a step; one that restarts() forgets when messages were met.
  void end_step(double time);

 private:
  double motion_start_ = 0.0;   // [s]
  double period_ = kMaxPeriod;  // [s]
  double last_message_ = -1.0;  // when the last message was met [s]; < 0: never
  double last_time_ = 0.0;      // of the last step [s]
};

}  // namespace pliant
