#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "pliant/scene/robot.h"
#include "pliant/scene/source_place.h"

namespace pliant {

/// Joint positions over time, from a YAML file:
///   joints: [a, b]
///   interpolation: linear | cubic      (cubic unless given)
///   loop: true | false                 (false unless given)
///   keyframes: [{time: 0.0, positions: [0.1, 0.2]}, ...]
/// Before the first keyframe and, without loop, after the last one, the positions are theirs.
/// Cubic is monotone between two keyframes (no overshoot) and stands still at the first, the last,
/// between equal ones, and where the motion turns back.
class Keyframes {
 public:
  enum class Interpolation { kLinear, kCubic };

  /// `positions` has a row a joint and a column a keyframe [m or rad]; `times` [s] rise by at least
  /// kMinInterval. With loop the last column equals the first. Throws InputError.
  Keyframes(std::vector<std::string> joints, std::vector<double> times, Eigen::MatrixXd positions,
            Interpolation interpolation, bool loop);

  static constexpr double kMinInterval = 1e-6;  ///< [s]
  static constexpr double kMaxTime = 1e7;       ///< [s]
  static constexpr double kMaxPosition = 1e6;   ///< [m or rad]

  const std::vector<std::string>& joints() const { return joints_; }
  const std::vector<double>& times() const { return times_; }
  const Eigen::MatrixXd& positions() const { return positions_; }
  double end_time() const { return times_.back(); }  ///< [s]
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
  std::vector<double> times_;
  Eigen::MatrixXd positions_;
  Eigen::MatrixXd slopes_;  // [m/s or rad/s]
  Interpolation interpolation_;
  bool loop_;
};

/// Throws InputError "FILE:LINE: ..." for whatever is wrong in the file.
Keyframes read_keyframes(const std::string& path);

/// Plays keyframes on a robot. Throws InputError for what Robot::find_joint() refuses and, where
/// Robot::limit_rule() says so, a position beyond the limits; messages begin with `where`.
std::shared_ptr<JointSource> make_keyframe_source(const Keyframes& keyframes, const Robot& robot,
                                                  const std::string& where);

}  // namespace pliant
