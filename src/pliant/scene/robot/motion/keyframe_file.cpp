#include "pliant/scene/robot/motion/keyframe_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "pliant/math/error.h"
#include "pliant/scene/reading/scene_readers.h"
#include "pliant/scene/yaml/place_error.h"
#include "pliant/scene/yaml/scene_formats.h"
#include "pliant/scene/yaml/yaml_map.h"

namespace pliant {
namespace {

constexpr std::size_t kMaxJoints = 1000;
constexpr double kMaxDistance = 1000.0;  // of a pose from the root link [m]
constexpr double kMaxAngle = 100.0;      // [rad]

using Joints = std::vector<std::string>;

std::vector<ParameterSpec> motion_parameters() {
  return {choice_parameter("interpolation", "cubic", {"linear", "cubic"},
                           "between two keyframes; cubic: without a corner and without overshoot, "
                           "at rest at the first, the last, at both ends of a straight path and "
                           "where the motion turns back"),
          flag_parameter("loop", "false",
                         "begins again after the last one, which must equal the first")};
}

std::vector<ParameterSpec> keyframe_parameters() {
  return {number_parameter("time", "s", "", 0.0, Keyframes::kMaxTime,
                           "since the start; each later than the one before")};
}

std::vector<ParameterSpec> keyframe_pose_parameters() {
  return {vector_parameter("position", "m", "", kMaxDistance,
                           "of the link's origin in the frame of the robot's root link"),
          vector_parameter("rotation_rpy", "rad", "", kMaxAngle,
                           "roll, pitch, yaw about the root link's axes x, y, z, in this order"),
          choice_parameter("path", "straight", {"straight", "joints"},
                           "straight: the link goes along a line and turns about one axis; joints: "
                           "each joint goes from one position to the other")};
}

Joints read_joints(const YamlNode& node) {
  Joints joints;
  for (const YamlNode& item : read_list(node, "joints", "a list of joint names")) {
    joints.push_back(read_text(item, fmt::format("joints[{}]", joints.size())));
    if (std::find(joints.begin(), joints.end() - 1, joints.back()) != joints.end() - 1) {
      throw InputError(
          fmt::format("{}: joint '{}' is listed twice", item.place().text(), joints.back()));
    }
    if (joints.size() > kMaxJoints) refuse_value(node, "joints", "at most 1000 joints");
  }
  return joints;
}

std::map<int, double> read_position_list(const YamlNode& node, const std::string& field,
                                         const Joints& joints, const std::string& expected) {
  const auto count = static_cast<int>(joints.size());
  const std::vector<double> values = read_numbers(
      node, field, count, count, -Keyframes::kMaxPosition, Keyframes::kMaxPosition, expected);
  std::map<int, double> positions;
  for (std::size_t j = 0; j < values.size(); ++j) positions[static_cast<int>(j)] = values[j];
  return positions;
}

std::map<int, double> read_position_map(const YamlNode& node, const std::string& field,
                                        const Joints& joints) {
  std::vector<ParameterSpec> specs;
  for (const std::string& joint : joints) {
    specs.push_back(number_parameter(joint, "m or rad", "0", -Keyframes::kMaxPosition,
                                     Keyframes::kMaxPosition, ""));
  }
  const YamlMap map(node, field, specs);
  std::map<int, double> positions;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (map.has(joints[j])) positions[static_cast<int>(j)] = map.number(joints[j]);
  }
  return positions;
}

KeyframePose read_keyframe_pose(const YamlNode& node, const std::string& field) {
  const YamlMap map(node, field, keyframe_pose_parameters(), {"link"});
  KeyframePose pose;
  const std::string link = map.field("link");
  pose.link = read_text(map.require("link", "the name of a link of the robot"), link);
  pose.root_from_link = read_pose(map);
  pose.is_straight = map.text("path") == "straight";
  pose.place = node.place();
  return pose;
}

Keyframe read_keyframe(const YamlNode& node, int number, const Joints& joints) {
  const YamlMap map(node, fmt::format("keyframes[{}]", number), keyframe_parameters(),
                    {"positions", "pose"});
  Keyframe keyframe;
  keyframe.time = map.number("time");
  keyframe.place = node.place();
  if (const YamlNode* pose = map.find("pose")) {
    keyframe.pose = read_keyframe_pose(*pose, map.field("pose"));
  }
  const std::string expected = fmt::format(
      "{} finite numbers in m or rad, one for each of 'joints'{}", joints.size(),
      number == 0 ? "" : ", or a map of some joints to their positions, or a 'pose' instead");
  const YamlNode* positions = map.find("positions");
  if (positions == nullptr) {
    if (!keyframe.pose) map.require("positions", expected);
    return keyframe;
  }
  const std::string field = map.field("positions");
  keyframe.positions = positions->kind == YamlNode::Kind::kMap
                           ? read_position_map(*positions, field, joints)
                           : read_position_list(*positions, field, joints, expected);
  return keyframe;
}

/// From the first keyframe on every joint has to be somewhere.
void check_first(const Keyframe& first, const Joints& joints) {
  if (first.pose) {
    throw InputError(fmt::format(
        "{}: keyframes[0] has a 'pose', but the first keyframe says where each joint is: inverse "
        "kinematics starts from there. Give 'positions', and the pose in the next keyframe",
        first.pose->place.text()));
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (first.positions.count(static_cast<int>(j)) > 0) continue;
    throw InputError(fmt::format(
        "{}: keyframes[0].positions has no '{}', but the first keyframe says where each joint is",
        first.place.text(), joints[j]));
  }
}

}  // namespace

std::vector<SceneFormat> keyframe_formats() {
  return {{"Keyframes",
           "How a robot's joints move: the file that `robot.keyframes` names, and that "
           "`robot_player` plays. Before the first keyframe and, without `loop`, after the last "
           "one, the joints are where these put them",
           {{"joints", "a list of names",
             "of joints with a position of their own: not fixed, mimicking, floating or planar"},
            {"keyframes", "a list of maps", "at least one; see below"}},
           motion_parameters(),
           "joints: [gantry_z, left_finger_joint, right_finger_joint]\n"
           "keyframes:\n"
           "  - {time: 0, positions: [0.2, 0.04, 0.04]}\n"
           "  - {time: 1, positions: {gantry_z: 0.0}}\n"
           "  - {time: 2, pose: {link: palm, position: [0, 0, 0.1], rotation_rpy: [0, 0, 0]}}\n"},
          {"Keyframe",
           "An item of `keyframes:`, with `positions`, a `pose` or both",
           {{"positions", "a list of numbers, or a map of joints and numbers",
             "[m or rad]; a list has one for each of `joints`; joints that a map leaves out stay. "
             "The first keyframe places all joints"},
            {"pose", "a map",
             "where a link has to be, found by inverse kinematics; the other "
             "joints stay, or go where `positions` says"}},
           keyframe_parameters()},
          {"Keyframe `pose`",
           "A map under `pose:`",
           {{"link", "the name of a link", "that joints of the file move"}},
           keyframe_pose_parameters()}};
}

bool KeyframeFile::has_poses() const {
  return std::any_of(keyframes.begin(), keyframes.end(),
                     [](const Keyframe& keyframe) { return keyframe.pose.has_value(); });
}

KeyframeFile read_keyframe_file(const std::string& path) {
  const YamlNode root = read_yaml_file(path);
  const YamlMap map(root, "", motion_parameters(), {"joints", "keyframes"});
  KeyframeFile file;
  file.joints = read_joints(map.require("joints", "a list of joint names"));
  file.interpolation = map.text("interpolation") == "linear" ? Keyframes::Interpolation::kLinear
                                                             : Keyframes::Interpolation::kCubic;
  file.loop = map.flag("loop");
  const std::string expected = "a list of {time: T, positions: [...]} or {time: T, pose: {...}}";
  const YamlNode& list = map.require("keyframes", expected);
  file.place = list.place();
  for (const YamlNode& item : read_list(list, "keyframes", expected)) {
    const auto number = static_cast<int>(file.keyframes.size());
    Keyframe keyframe = read_keyframe(item, number, file.joints);
    if (number > 0 && !(keyframe.time - file.keyframes.back().time >= Keyframes::kMinInterval)) {
      throw InputError(fmt::format(
          "{}: keyframes[{}].time is {} s, but must be at least {:g} s after the one before ({} s)",
          item.place().text(), number, keyframe.time, Keyframes::kMinInterval,
          file.keyframes.back().time));
    }
    file.keyframes.push_back(std::move(keyframe));
  }
  check_first(file.keyframes.front(), file.joints);
  return file;
}

Keyframes read_keyframes(const std::string& path, const Robot* robot) {
  return make_keyframes(read_keyframe_file(path), robot);
}

}  // namespace pliant
