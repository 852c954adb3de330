#pragma once

#include <sensor_msgs/JointState.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "pliant/ros/robot/even_motion.h"
#include "pliant/ros/robot/joint_path.h"
#include "pliant/ros/robot/sender_lag.h"
#include "pliant/scene/robot/robot.h"

namespace pliant {

/// Joint positions of one robot from joint_states messages. Where their stamps are simulated times
/// the joints are where JointPath says; else they move between two messages as EvenMotion says. One
/// that turns without end takes the shorter way.
class JointStateSource final : public JointSource {
 public:
  static constexpr double kMaxPosition = 1e6;  ///< a greater one is refused [m or rad]

  /// `stamps_are_simulated`: senders know the simulated time, since this node publishes /clock.
  explicit JointStateSource(std::shared_ptr<const Robot> robot, bool stamps_are_simulated = false);

  /// Takes a message over, from any thread; joints of other robots are left out. Throws InputError
  /// for values that are not finite or too great, or for sizes that differ; then nothing changed.
  void set(const sensor_msgs::JointState& message);

  /// Before the first step (time 0) joints jump to the last message.
  void positions(double time, std::vector<double>& positions) override;

  /// That stamps are not of the simulated time, which is then of no use; empty: they are.
  std::string note() const;
  /// Between a stamp and the simulated time at which the joints are there [s]; of the stepping
  /// thread.
  double delay() const { return path_.delay(); }

  /// Whether a step from `time` [s] would run ahead of the sender (SenderLag); of the stepping
  /// thread, as are the next two.
  bool runs_ahead(double time) const;
  /// Returns for how long at most [s of wall time].
  double begin_waiting() { return lag_.begin_waiting(); }
  void stop_waiting() { lag_.give_up(); }
  const SenderLag& lag() const { return lag_; }

 private:
  struct Message {
    double stamp;                   // [s]
    std::vector<double> positions;  // NaN: of another message
  };
  std::vector<Message> take_messages();
  void begin_run(double time, std::vector<double>& positions);
  bool is_of_last_run(const Message& message, double time) const;
  bool knows_time(const Message& message, double time) const;
  void follow(const Message& message, double time, const std::vector<double>& positions);
  void start_motion(const Message& message, double time, const std::vector<double>& positions);
  void move(double time, std::vector<double>& positions) const;
  double change(std::size_t joint, double from, double to) const;

  std::shared_ptr<const Robot> robot_;
  bool stamps_are_simulated_;

  mutable std::mutex mutex_;
  std::vector<double> requested_;   // guarded by mutex_
  std::vector<Message> messages_;   // guarded by mutex_: that the stepping thread has not seen
  std::vector<double> of_message_;  // guarded by mutex_: work space
  std::string note_;                // guarded by mutex_

  // Of the stepping thread.
  std::vector<double> target_, start_, difference_;
  EvenMotion motion_;
  bool follows_path_ = false;
  JointPath path_;
  SenderLag lag_;
  std::vector<double> last_;        // knot of the path; NaN: none
  std::vector<double> offset_;      // from a path where it began, which fades
  std::vector<double> path_start_;  // of each joint [s]
  double run_start_ = 0.0;          // [s]
};

}  // namespace pliant
