#pragma once

#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/scene/robot/motion/keyframes.h"
#include "pliant/scene/robot/robot.h"
#include "pliant/scene/yaml/source_place.h"

namespace pliant {

/// Where a link has to be at a keyframe, and how it comes there from the keyframe before.
struct KeyframePose {
  std::string link;
  Eigen::Isometry3d root_from_link = Eigen::Isometry3d::Identity();
  bool is_straight = true;  ///< else joints go from one value to the other
  SourcePlace place;
};

struct Keyframe {
  double time = 0.0;  ///< [s]
  /// Joint [index in the file's list] -> position [m or rad]. The others stay as they are, unless
  /// they move the link of `pose`.
  std::map<int, double> positions;
  std::optional<KeyframePose> pose;
  SourcePlace place;
};

/// A YAML file of keyframes:
///   joints: [a, b, grip]
///   interpolation: linear | cubic      (cubic unless given)
///   loop: true | false                 (false unless given)
///   keyframes:
///     - {time: 0, positions: [0.1, 0.2, 0]}        a position for each joint
///     - {time: 1, positions: {grip: 0.01}}         the other joints stay where they are
///     - {time: 2, pose: {link: tool, position: [0.4, 0, 0.2], rotation_rpy: [3.14159, 0, 0]}}
/// A pose is that of a link in the frame of the robot's root link, in m and rad. The path to it is
/// straight unless the pose has `path: joints`. It may stand beside `positions` of joints that do
/// not move the link. The first keyframe has a position for each joint.
struct KeyframeFile {
  std::vector<std::string> joints;
  Keyframes::Interpolation interpolation = Keyframes::Interpolation::kCubic;
  bool loop = false;
  std::vector<Keyframe> keyframes;
  SourcePlace place;  ///< of the list

  bool has_poses() const;
};

/// Throws InputError "FILE:LINE: ..." for whatever is wrong in the file.
KeyframeFile read_keyframe_file(const std::string& path);

/// Solves the poses by inverse kinematics, each from the joint positions of the keyframe before,
/// and straight paths between them in small steps, so that nothing is left to solve when they are
/// played. `robot` may be null for a file without poses. Throws InputError "FILE:LINE: ..." for a
/// pose that the robot does not reach (with how far it comes), for a straight path that leaves what
/// it reaches, and for links and joints that do not go together.
Keyframes make_keyframes(const KeyframeFile& file, const Robot* robot);

/// Both of them.
Keyframes read_keyframes(const std::string& path, const Robot* robot = nullptr);

}  // namespace pliant
