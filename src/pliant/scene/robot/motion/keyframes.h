#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "pliant/scene/robot/robot.h"
#include "pliant/scene/yaml/source_place.h"

namespace pliant {

/// Joint positions at some times: those of the keyframes, and some between them where a link
/// follows a straight line.
struct KeyframeSamples {
  std::vector<double> times;   ///< [s]
  Eigen::MatrixXd positions;   ///< a row a joint, a column a time [m or rad]
  std::vector<int> keyframes;  ///< of each column: the number of the keyframe, or of the next one
  std::vector<bool> rests;     ///< of each column: cubic interpolation stands still there
};

/// Joint positions over time, as keyframe_file.h reads them.
/// Before the first keyframe and, without loop, after the last one, the positions are theirs.
/// Cubic is monotone between two samples (no overshoot) and stands still at the first, the last,
/// between equal ones, where the motion turns back, and where `rests` says so.
class Keyframes {
 public:
  enum class Interpolation { kLinear, kCubic };

  /// Times rise by at least kMinInterval. With loop the last column equals the first. Throws
  /// InputError.
  Keyframes(std::vector<std::string> joints, KeyframeSamples samples, Interpolation interpolation,
            bool loop);
  /// The same of keyframes alone: `positions` has a column for each of them.
  Keyframes(std::vector<std::string> joints, std::vector<double> times, Eigen::MatrixXd positions,
            Interpolation interpolation, bool loop);

  static constexpr double kMinInterval = 1e-6;  ///< [s]
  static constexpr double kMaxTime = 1e7;       ///< [s]
  static constexpr double kMaxPosition = 1e6;   ///< [m or rad]

  const std::vector<std::string>& joints() const { return joints_; }
  const KeyframeSamples& samples() const { return samples_; }
  double end_time() const { return samples_.times.back(); }  ///< [s]
  bool loop() const { return loop_; }

  /// The greatest speed of joint number `joint` [m/s or rad/s] and the keyframes that it lies
  /// between [s].
  struct Speed {
    double value = 0.0, from = 0.0, until = 0.0;
  };
  Speed top_speed(int joint) const;

  /// Position of joint number `joint` at `time` [s].
  double position(int joint, double time) const;

 private:
  void compute_slopes();

  std::vector<std::string> joints_;
  KeyframeSamples samples_;
  Eigen::MatrixXd slopes_;  // [m/s or rad/s]
  Interpolation interpolation_;
  bool loop_;
};

/// Plays keyframes on a robot. Throws InputError for what Robot::find_joint() refuses and, where
/// Robot::limit_rule() says so, a position beyond the limits; messages begin with `where`.
std::shared_ptr<JointSource> make_keyframe_source(const Keyframes& keyframes, const Robot& robot,
                                                  const std::string& where);

}  // namespace pliant
