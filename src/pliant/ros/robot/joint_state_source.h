#pragma once

#include <sensor_msgs/JointState.h>

#include <memory>
#include <mutex>
#include <vector>

#include "pliant/ros/robot/even_motion.h"
#include "pliant/scene/robot/robot.h"

namespace pliant {

/// Joint positions of one robot from joint_states messages. Between two messages the joints move as
/// EvenMotion says. One that turns without end takes the shorter way.
class JointStateSource final : public JointSource {
 public:
  static constexpr double kMaxPosition = 1e6;  ///< a greater one is refused [m or rad]

  explicit JointStateSource(std::shared_ptr<const Robot> robot);

  /// Takes a message over, from any thread; joints of other robots are left out. Throws InputError
  /// for values that are not finite or too great, or for sizes that differ; then nothing changed.
  void set(const sensor_msgs::JointState& message);

  /// Before the first step (time 0) joints jump to the last message.
  void positions(double time, std::vector<double>& positions) override;

 private:
  void start_motion(double time, const std::vector<double>& positions);

  std::shared_ptr<const Robot> robot_;

  mutable std::mutex mutex_;
  std::vector<double> requested_;  // guarded by mutex_
  bool fresh_ = false;             // guarded by mutex_: the stepping thread has not seen requested_

  // Of the stepping thread.
  std::vector<double> target_, start_, difference_;
  EvenMotion motion_;
};

}  // namespace pliant
