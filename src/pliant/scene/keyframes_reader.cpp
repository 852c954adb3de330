#include <fmt/format.h>

#include <algorithm>

#include "pliant/math/error.h"
#include "pliant/scene/keyframes.h"
#include "pliant/scene/place_error.h"
#include "pliant/scene/scene_formats.h"
#include "pliant/scene/yaml_map.h"

namespace pliant {
namespace {

constexpr std::size_t kMaxJoints = 1000;

std::vector<std::string> read_joints(const YamlNode& node) {
  std::vector<std::string> joints;
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

std::vector<ParameterSpec> motion_parameters() {
  return {choice_parameter("interpolation", "cubic", {"linear", "cubic"},
                           "between two keyframes; cubic: without a corner and without overshoot, "
                           "at rest at the first, the last and where the motion turns back"),
          flag_parameter("loop", "false",
                         "begins again after the last one, which must equal the first")};
}

std::vector<ParameterSpec> frame_parameters() {
  return {number_parameter("time", "s", "", 0.0, Keyframes::kMaxTime,
                           "since the start; each later than the one before")};
}

struct Frame {
  double time;
  std::vector<double> positions;
};

Frame read_frame(const YamlNode& node, const std::string& field, int joints) {
  const YamlMap map(node, field, frame_parameters(), {"positions"});
  const std::string expected =
      fmt::format("{} finite numbers in m or rad, one for each of 'joints'", joints);
  return {map.number("time"),
          read_numbers(map.require("positions", expected), map.field("positions"), joints, joints,
                       -Keyframes::kMaxPosition, Keyframes::kMaxPosition, expected)};
}

}  // namespace

std::vector<SceneFormat> keyframe_formats() {
  return {{"Keyframes",
           "How a robot's joints move: the file that `robot.keyframes` names, and that "
           "`robot_player` plays. Before the first keyframe and, without `loop`, after the last "
           "one, the joints are where these put them",
           {{"joints", "a list of names",
             "of joints with a position of their own: not fixed, mimicking, floating or planar"},
            {"keyframes", "a list of {time, positions}", "at least one"}},
           motion_parameters(),
           "joints: [gantry_z, left_finger_joint, right_finger_joint]\n"
           "keyframes:\n"
           "  - {time: 0, positions: [0.2, 0.04, 0.04]}\n"
           "  - {time: 1, positions: [0.0, 0.04, 0.04]}\n"
           "  - {time: 1.5, positions: [0.0, 0.01, 0.01]}\n"},
          {"Keyframe",
           "An item of `keyframes:`",
           {{"positions", "a list of numbers", "one for each of `joints` [m or rad]"}},
           frame_parameters()}};
}

Keyframes read_keyframes(const std::string& path) {
  const YamlNode root = read_yaml_file(path);
  const YamlMap map(root, "", motion_parameters(), {"joints", "keyframes"});
  std::vector<std::string> joints = read_joints(map.require("joints", "a list of joint names"));
  const std::string expected = "a list of {time: T, positions: [...]}";
  const YamlNode& list = map.require("keyframes", expected);
  const auto& items = read_list(list, "keyframes", expected);
  const auto rows = static_cast<int>(joints.size());
  std::vector<double> times;
  Eigen::MatrixXd positions(rows, static_cast<Eigen::Index>(items.size()));
  for (std::size_t k = 0; k < items.size(); ++k) {
    const Frame frame = read_frame(items[k], fmt::format("keyframes[{}]", k), rows);
    if (k > 0 && !(frame.time - times.back() >= Keyframes::kMinInterval)) {
      throw InputError(fmt::format(
          "{}: keyframes[{}].time is {} s, but must be at least {:g} s after the one before ({} s)",
          items[k].place().text(), k, frame.time, Keyframes::kMinInterval, times.back()));
    }
    times.push_back(frame.time);
    positions.col(static_cast<Eigen::Index>(k)) =
        Eigen::Map<const Eigen::VectorXd>(frame.positions.data(), rows);
  }
  const auto interpolation = map.text("interpolation") == "linear"
                                 ? Keyframes::Interpolation::kLinear
                                 : Keyframes::Interpolation::kCubic;
  return with_place(list.place().text(), [&] {
    return Keyframes(std::move(joints), std::move(times), std::move(positions), interpolation,
                     map.flag("loop"));
  });
}

}  // namespace pliant
