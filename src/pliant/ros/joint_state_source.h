#pragma once

#include <sensor_msgs/JointState.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <vector>

#include "pliant/scene/robot.h"

namespace pliant {

/// Joint positions from joint_states messages. Between two messages the joints move evenly from
/// where they are to where the newer one wants them, over the simulated time that lay between the
/// last two messages (at most kMaxPeriod, at least half of what it was before). One that turns
/// without end takes the shorter way.
class JointStateSource final : public JointSource {
 public:
  static constexpr double kMaxPeriod = 0.2;    ///< [s]
  static constexpr double kMaxPosition = 1e6;  ///< a greater one is refused [m or rad]

  explicit JointStateSource(std::shared_ptr<const Robot> robot);

  /// Takes a message over, from any thread. Throws InputError for values that are not finite or too
  /// great, or for sizes that differ; then nothing changed.
  void set(const sensor_msgs::JointState& message);
  /// As set(), but warns (at most once in 5 s of wall time) instead of throwing.
  void on_message(const sensor_msgs::JointStateConstPtr& message);
  /// Whether there was a message; thread-safe.
  bool received() const;

  /// Before the first step (time 0) joints jump to the last message.
  void positions(double time, std::vector<double>& positions) override;

 private:
  void start_motion(double time, const std::vector<double>& positions);

  std::shared_ptr<const Robot> robot_;

  mutable std::mutex mutex_;
  std::vector<double> requested_;  // guarded by mutex_
  bool received_ = false;          // guarded by mutex_
  bool fresh_ = false;             // guarded by mutex_: the stepping thread has not seen requested_

  // Of the stepping thread.
  std::vector<double> target_, start_, difference_;
  double motion_start_ = 0.0;   // [s]
  double period_ = kMaxPeriod;  // [s]
  double last_message_ = -1.0;  // when the last message was met [s]; < 0: never
  double last_time_ = 0.0;      // of the last call [s]

  std::chrono::steady_clock::time_point last_warning_;
};

}  // namespace pliant
