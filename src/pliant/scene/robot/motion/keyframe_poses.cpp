#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"
#include "pliant/math/pi.h"
#include "pliant/scene/robot/motion/inverse_kinematics.h"
#include "pliant/scene/robot/motion/keyframe_file.h"
#include "pliant/scene/yaml/place_error.h"

namespace pliant {
namespace {

// A straight path is cut into steps of at most these, of which none may turn a joint by more than
// kMaxJointStep, so that the link stays within 1 mm of it (the bow of an arm of 1 m over 0.09 rad).
constexpr double kStepLength = 0.005;   // [m]
constexpr double kStepAngle = 0.02;     // [rad]
constexpr double kMaxJointStep = 0.09;  // [m or rad]
constexpr int kFinest = 16;             // times as many steps before a straight path is refused

double in_degrees(double angle) { return angle * 180.0 / kPi; }

/// How a robot's joint positions come from keyframes.
class KeyframeSolver {
 public:
  KeyframeSolver(const KeyframeFile& file, const Robot* robot) : file_(file), robot_(robot) {
    if (!file.has_poses()) return;
    const auto with_pose = std::find_if(file.keyframes.begin(), file.keyframes.end(),
                                        [](const Keyframe& k) { return k.pose.has_value(); });
    if (robot == nullptr) {
      throw InputError(
          fmt::format("{}: keyframes[{}] has a 'pose', for which the robot's URDF has to be known",
                      with_pose->pose->place.text(), with_pose - file.keyframes.begin()));
    }
    find_joints();
  }

  Keyframes solve() {
    const auto joints = static_cast<Eigen::Index>(file_.joints.size());
    Eigen::VectorXd now = Eigen::VectorXd::Zero(joints);
    for (number_ = 0; number_ < static_cast<int>(file_.keyframes.size()); ++number_) {
      const Keyframe& keyframe = file_.keyframes[static_cast<std::size_t>(number_)];
      Eigen::VectorXd next = now;
      for (const auto& [joint, position] : keyframe.positions) next[joint] = position;
      if (keyframe.pose) {
        with_place(keyframe.pose->place.text(), [&] { follow(keyframe, now, next); });
      } else {
        add(keyframe.time, next, false);
      }
      now = next;
    }
    return with_place(file_.place.text(), [&] {
      samples_.positions.resize(joints, static_cast<Eigen::Index>(columns_.size()));
      for (std::size_t k = 0; k < columns_.size(); ++k) {
        samples_.positions.col(static_cast<Eigen::Index>(k)) = columns_[k];
      }
      return Keyframes(file_.joints, std::move(samples_), file_.interpolation, file_.loop);
    });
  }

 private:
  std::string label() const { return fmt::format("keyframes[{}].pose", number_); }

  /// A link's name, which may leave out the robot's prefix.
  std::string full_name(const std::string& link) const {
    return robot_->link_index(link) ? link : robot_->prefix() + link;
  }

  void add(double time, const Eigen::VectorXd& positions, bool rests) {
    samples_.times.push_back(time);
    samples_.keyframes.push_back(number_);
    samples_.rests.push_back(rests);
    columns_.push_back(positions);
  }

  /// The robot's joints that the file names.
  void find_joints() {
    for (const std::string& joint : file_.joints) {
      const int index = with_place(file_.place.file, [&] { return robot_->find_joint(joint); });
      indices_.push_back(index);
    }
  }

  std::vector<double> of_robot(const Eigen::VectorXd& positions) const {
    std::vector<double> all = robot_->initial_positions();
    for (std::size_t j = 0; j < indices_.size(); ++j) {
      all[static_cast<std::size_t>(indices_[j])] = positions[static_cast<Eigen::Index>(j)];
    }
    return all;
  }

  Eigen::VectorXd of_file(const std::vector<double>& all) const {
    Eigen::VectorXd positions(static_cast<Eigen::Index>(indices_.size()));
    for (std::size_t j = 0; j < indices_.size(); ++j) {
      positions[static_cast<Eigen::Index>(j)] = all[static_cast<std::size_t>(indices_[j])];
    }
    return positions;
  }

  const InverseKinematics& kinematics_of(const KeyframePose& pose) {
    const auto found = kinematics_.find(pose.link);
    if (found != kinematics_.end()) return found->second;
    InverseKinematics made =
        with_place(label(), [&] { return InverseKinematics(*robot_, full_name(pose.link)); });
    for (const int joint : made.joints()) {
      if (std::count(indices_.begin(), indices_.end(), joint) > 0) continue;
      throw InputError(fmt::format("{}: link '{}' is moved by joint '{}', which 'joints' lacks",
                                   label(), pose.link,
                                   robot_->joint_names()[static_cast<std::size_t>(joint)]));
    }
    return kinematics_.emplace(pose.link, std::move(made)).first->second;
  }

  /// `next` comes with the positions that the keyframe gives, and leaves with all of them.
  void follow(const Keyframe& keyframe, const Eigen::VectorXd& now, Eigen::VectorXd& next) {
    const KeyframePose& pose = *keyframe.pose;
    const InverseKinematics& kinematics = kinematics_of(pose);
    for (const auto& [joint, position] : keyframe.positions) {
      const int index = indices_[static_cast<std::size_t>(joint)];
      if (std::count(kinematics.joints().begin(), kinematics.joints().end(), index) == 0) continue;
      throw InputError(fmt::format(
          "keyframes[{}].positions: joint '{}' moves link '{}', whose 'pose' says where it is",
          number_, file_.joints[static_cast<std::size_t>(joint)], pose.link));
    }
    if (!pose.is_straight) {
      check_reach(kinematics, pose, next);
      next = of_file(kinematics.solve(pose.root_from_link, of_robot(next)).positions);
      add(keyframe.time, next, false);
      return;
    }
    for (int finer = 1; !try_straight(kinematics, keyframe, now, next, finer); finer *= 2) {
      if (finer < kFinest) continue;
      throw InputError(fmt::format(
          "{}: on the straight path to it a joint would have to turn suddenly, as near a singular "
          "configuration (an arm stretched out, two axes in line); give `path: joints`, or another "
          "keyframe between",
          label()));
    }
  }

  void check_reach(const InverseKinematics& kinematics, const KeyframePose& pose,
                   const Eigen::VectorXd& start) const {
    const auto found = kinematics.solve(pose.root_from_link, of_robot(start));
    if (found.reached) return;
    const Eigen::Vector3d nearest = kinematics.pose(found.positions).translation();
    throw InputError(fmt::format(
        "{}: link '{}' does not reach it: the nearest that was found is {:.4f} m and {:.2f} "
        "degrees away, at position [{:.4f}, {:.4f}, {:.4f}]{}",
        label(), pose.link, found.distance, in_degrees(found.angle), nearest.x(), nearest.y(),
        nearest.z(), limits_met(kinematics, found.positions)));
  }

  std::string limits_met(const InverseKinematics& kinematics,
                         const std::vector<double>& positions) const {
    std::string text;
    for (const int joint : kinematics.joints()) {
      const Robot::Limits limits = robot_->limits(joint);
      const double position = positions[static_cast<std::size_t>(joint)];
      if (position > limits.lower && position < limits.upper) continue;
      text += fmt::format("{} '{}' ({:g})", text.empty() ? ", with these joints at a limit:" : ",",
                          robot_->joint_names()[static_cast<std::size_t>(joint)], position);
    }
    return text;
  }

  /// Share of the path that is done at a share of the time.
  double progress(double share) const {
    if (file_.interpolation == Keyframes::Interpolation::kLinear) return share;
    return share * share * (3.0 - 2.0 * share);
  }

  /// Adds a straight path to the samples. False, and nothing is added, where steps are too coarse.
  bool try_straight(const InverseKinematics& kinematics, const Keyframe& keyframe,
                    const Eigen::VectorXd& now, Eigen::VectorXd& next, int finer) {
    const Eigen::Isometry3d from = kinematics.pose(of_robot(now));
    const Eigen::Isometry3d& to = keyframe.pose->root_from_link;
    const Eigen::Vector3d displacement = to.translation() - from.translation();
    const Eigen::AngleAxisd turn(from.linear().transpose() * to.linear());
    const double start_time = samples_.times.back();
    const double duration = keyframe.time - start_time;
    const double steps_wanted =
        1.5 * std::max(displacement.norm() / kStepLength, std::abs(turn.angle()) / kStepAngle) *
        finer;
    const int steps = static_cast<int>(
        std::clamp(std::ceil(steps_wanted), 1.0, std::floor(duration / Keyframes::kMinInterval)));
    std::vector<Eigen::VectorXd> columns;
    std::vector<double> last = of_robot(now);
    for (int k = 1; k <= steps; ++k) {
      const double share = progress(static_cast<double>(k) / steps);
      Eigen::Isometry3d target = Eigen::Isometry3d::Identity();
      target.translation() = from.translation() + share * displacement;
      target.linear() =
          from.linear() * Eigen::AngleAxisd(share * turn.angle(), turn.axis()).toRotationMatrix();
      const auto found = kinematics.step(k == steps ? to : target, last);
      if (!found.reached) {
        check_reach(kinematics, *keyframe.pose, next);
        refuse_path(kinematics, *keyframe.pose, found, share * displacement.norm(),
                    displacement.norm());
      }
      for (const int joint : kinematics.joints()) {
        const auto j = static_cast<std::size_t>(joint);
        if (std::abs(found.positions[j] - last[j]) > kMaxJointStep) return false;
      }
      last = found.positions;
      columns.push_back(blended(now, next, share, kinematics, of_file(last)));
    }
    samples_.rests.back() = true;
    for (int k = 1; k < steps; ++k) {
      add(start_time + duration * k / steps, columns[static_cast<std::size_t>(k - 1)], false);
    }
    next = columns.back();
    add(keyframe.time, next, true);
    return true;
  }

  /// Joints that do not move the link go from `now` to `next` meanwhile.
  Eigen::VectorXd blended(const Eigen::VectorXd& now, const Eigen::VectorXd& next, double share,
                          const InverseKinematics& kinematics, Eigen::VectorXd positions) const {
    for (std::size_t j = 0; j < indices_.size(); ++j) {
      const auto& moving = kinematics.joints();
      if (std::count(moving.begin(), moving.end(), indices_[j]) > 0) continue;
      const auto row = static_cast<Eigen::Index>(j);
      positions[row] = share == 1.0 ? next[row] : now[row] + share * (next[row] - now[row]);
    }
    return positions;
  }

  [[noreturn]] void refuse_path(const InverseKinematics& kinematics, const KeyframePose& pose,
                                const InverseKinematics::Solution& found, double done,
                                double length) const {
    throw InputError(fmt::format(
        "{}: link '{}' reaches it, but not on a straight path from the keyframe before: after "
        "{:.4f} "
        "of {:.4f} m it is {:.4f} m and {:.2f} degrees off{}; give `path: joints`, or another "
        "keyframe between",
        label(), pose.link, done, length, found.distance, in_degrees(found.angle),
        limits_met(kinematics, found.positions)));
  }

  const KeyframeFile& file_;
  const Robot* robot_;
  std::vector<int> indices_;  // of the robot's joints
  std::map<std::string, InverseKinematics> kinematics_;
  int number_ = 0;  // of the keyframe that is solved
  KeyframeSamples samples_;
  std::vector<Eigen::VectorXd> columns_;
};

}  // namespace

Keyframes make_keyframes(const KeyframeFile& file, const Robot* robot) {
  return KeyframeSolver(file, robot).solve();
}

}  // namespace pliant
