#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/math/error.h"
#include "pliant/scene/reading/scene_readers.h"
#include "pliant/scene/robot/robot_parameters.h"
#include "pliant/scene/yaml/place_error.h"

namespace pliant {
namespace {

using NamedValues = std::map<std::string, RobotSpec::NamedValue>;

/// The entries of a map of names and numbers; `what` they are.
NamedValues read_named_values(const YamlMap& map, const std::string& key, const std::string& what) {
  NamedValues values;
  const YamlNode* node = map.find(key);
  if (node == nullptr) return values;
  if (node->kind != YamlNode::Kind::kMap || node->entries.empty()) {
    refuse_value(*node, map.field(key), what);
  }
  for (const YamlEntry& entry : node->entries) {
    const std::string field = map.field(key) + "." + entry.key;
    const double value =
        parse_number(parameter_text(entry.value, field), entry.value.place().text() + ": " + field);
    values[entry.key] = {value, entry.key_place};
  }
  return values;
}

/// The same, of values that `allowed` allows.
NamedValues read_link_values(const YamlMap& map, const std::string& key, const std::string& what,
                             const ParameterSpec& allowed) {
  const NamedValues values = read_named_values(map, key, what);
  for (const auto& [link, given] : values) {
    if (given.value >= allowed.min && given.value <= allowed.max) continue;
    throw InputError(fmt::format("{}: {}.{} is {:g}, but must be {}", given.place.text(),
                                 map.field(key), link, given.value, allowed.range_text()));
  }
  return values;
}

std::vector<LinkChoice::Pattern> read_patterns(const YamlMap& map, const std::string& key) {
  std::vector<LinkChoice::Pattern> patterns;
  const YamlNode* list = map.find(key);
  if (list == nullptr) return patterns;
  const std::string field = map.field(key);
  for (const YamlNode& item :
       read_list(*list, field, "a list of links, or patterns such as '*_tip'")) {
    patterns.push_back(
        {read_text(item, fmt::format("{}[{}]", field, patterns.size())), item.place()});
  }
  return patterns;
}

LinkChoice read_links(const YamlMap& robot) {
  const YamlNode* node = robot.find("links");
  if (node == nullptr) return {};
  const YamlMap map(*node, robot.field("links"), {}, {"include", "exclude"});
  return {read_patterns(map, "include"), read_patterns(map, "exclude")};
}

ColliderKind read_collider(const YamlNode& node, const std::string& field) {
  return with_place(node.place().text() + ": " + field,
                    [&] { return find_collider(read_text(node, field)); });
}

/// One kind for all links, or a map of links and kinds.
LinkColliders read_colliders(const YamlNode& node, const std::string& field) {
  LinkColliders colliders;
  if (node.kind != YamlNode::Kind::kMap) {
    colliders.all = read_collider(node, field);
    return colliders;
  }
  if (node.entries.empty()) {
    refuse_value(
        node, field,
        fmt::format("one of {}, or a map of links and such", fmt::join(collider_names(), ", ")));
  }
  for (const YamlEntry& entry : node.entries) {
    colliders.of_link[entry.key] = read_collider(entry.value, field + "." + entry.key);
  }
  return colliders;
}

JointLimitRule read_limit_rule(const std::string& text) {
  if (text == "clamp") return JointLimitRule::kClamp;
  if (text == "warn") return JointLimitRule::kWarn;
  return text == "ignore" ? JointLimitRule::kIgnore : JointLimitRule::kRefuse;
}

std::vector<std::string> key_names() {
  std::vector<std::string> names;
  for (const KeyText& key : robot_keys()) names.push_back(key.name);
  return names;
}

RobotSpec read_robot(const YamlNode& node, const std::string& field, const FiniteCheck& limits,
                     const PackageResolver& resolver) {
  const YamlMap map(node, field, joined(pose_parameters(limits), robot_parameters()), key_names());
  RobotSpec robot;
  robot.field = field;
  robot.place = node.place();
  if (const YamlNode* urdf = map.find("urdf")) {
    robot.urdf_path = read_path(*urdf, map.field("urdf"), resolver);
  }
  if (const YamlNode* keyframes = map.find("keyframes")) {
    robot.keyframes_path = read_path(*keyframes, map.field("keyframes"), resolver);
    robot.keyframes_place = keyframes->place();
  }
  if (const YamlNode* prefix = map.find("prefix")) {
    robot.prefix = read_text(*prefix, map.field("prefix"));
  }
  if (const YamlNode* frame = map.find("base_frame")) {
    robot.base_frame = read_text(*frame, map.field("base_frame"));
    robot.base_frame_place = frame->place();
  }
  robot.touching = read_links(map);
  if (const YamlNode* colliders = map.find("colliders")) {
    robot.colliders = read_colliders(*colliders, map.field("colliders"));
  }
  robot.visual_shapes = map.text("collision") == "visual";
  robot.limit_rule = read_limit_rule(map.text("limits"));
  robot.world_from_base = read_pose(map);
  robot.friction = map.optional_number("friction");
  robot.temperature = map.optional_number("temperature");
  robot.limit_efforts = map.text("effort") == "limit";
  robot.efforts = read_named_values(map, "efforts", "a map of joints and their efforts");
  robot.initial = read_named_values(map, "initial", "a map of joints and their positions");
  robot.link_friction = read_link_values(
      map, "link_friction", "a map of links and their Coulomb coefficients", friction_parameter());
  robot.link_temperatures =
      read_link_values(map, "link_temperatures", "a map of links and their temperatures [K]",
                       temperature_parameter());
  return robot;
}

}  // namespace

std::vector<ParameterSpec> robot_parameters() {
  return {friction_parameter(), temperature_parameter(),
          choice_parameter("collision", "given", {"given", "visual"},
                           "shapes of links: given: collision shapes, and links without one touch "
                           "nothing; visual: these take their visual shapes"),
          choice_parameter("limits", "refuse", {"refuse", "clamp", "warn", "ignore"},
                           "what becomes of a joint beyond its limits: refuse: keyframes and "
                           "'initial' are refused, joint_states followed with a warning; clamp: it "
                           "stays at the limit; warn, ignore: it goes there"),
          choice_parameter("effort", "ignore", {"ignore", "limit"},
                           "what bodies that press on links do to joints: ignore: nothing, they "
                           "move as they are told to; limit: a joint stalls where they press "
                           "with the `effort` of its URDF limit, or have no room")};
}

const std::vector<KeyText>& robot_keys() {
  static const std::vector<KeyText> keys = {
      {"urdf", "a path or package://NAME/FILE",
       "the robot; in a node, `robot_description` takes its place"},
      {"keyframes", "a path or package://NAME/FILE",
       "motion of its joints; in a node, joint_states take their place"},
      {"initial", "a map of joints and positions [m or rad]",
       "where joints are until something moves them; 0, or the nearest limit, without"},
      {"efforts", "a map of joints and forces [N] or torques [N m]",
       "where these joints stall, whatever `effort` says; in the place of the URDF's"},
      {"prefix", "a text",
       "before the names of its links and joints, which so differ from those of "
       "another robot; in this map and in keyframes it may be left out"},
      {"base_frame", "a tf frame",
       "what the base follows in a node; `position` and `rotation_rpy` are then in that frame"},
      {"links", "a map with `include` and `exclude`, lists of links or patterns (*, ?, [...])",
       "the links that bodies touch; no mesh of another is read"},
      {"colliders", "auto, exact, repaired, convex or thick_shell, or a map of links and such",
       "what solids collision meshes stand for"},
      {"link_friction", "a map of links and Coulomb coefficients", "take the place of `friction`"},
      {"link_temperatures", "a map of links and temperatures [K]",
       "take the place of `temperature`"},
  };
  return keys;
}

std::vector<RobotSpec> read_robots(const YamlNode& node, const FiniteCheck& limits,
                                   const PackageResolver& resolver) {
  if (node.kind != YamlNode::Kind::kList) return {read_robot(node, "robot", limits, resolver)};
  std::vector<RobotSpec> robots;
  for (const YamlNode& item : read_list(node, "robot", "a map, or a list of maps, one a robot")) {
    const std::string field = fmt::format("robot[{}]", robots.size());
    robots.push_back(read_robot(item, field, limits, resolver));
  }
  return robots;
}

}  // namespace pliant
