#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "pliant/geometry/primitive_shapes.h"
#include "pliant/math/error.h"
#include "pliant/scene/obstacle_parameters.h"
#include "pliant/scene/place_error.h"
#include "pliant/scene/scene_readers.h"

namespace pliant {
namespace {

/// The keys that give a shape its size.
const std::map<std::string, std::vector<ParameterSpec>>& shape_parameters() {
  const auto length = [](const char* name, const char* meaning) {
    return number_parameter(name, "m", "", kMinShapeSize, kMaxShapeSize, meaning);
  };
  static const std::map<std::string, std::vector<ParameterSpec>> shapes = {
      {"plane", {}},
      {"sphere", {length("radius", "of the sphere")}},
      {"box", {vector_parameter("size", "m", "", kMaxShapeSize, "full extents")}},
      {"capsule", {length("radius", "of the ends"), length("length", "of the cylinder part")}},
      {"cylinder", {length("radius", "of the cylinder"), length("length", "of the cylinder")}},
      {"mesh",
       {scale_parameter(),
        number_parameter("voxel_size", "m", "0", 0.0, kMaxShapeSize,
                         "spacing of the distance samples; 0 chooses"),
        choice_parameter(
            "collider", "auto", collider_names(),
            "what solid the mesh stands for; auto: the first of the others that suits"),
        number_parameter("thickness", "m", "0", 0.0, kMaxShapeSize,
                         "of a thick shell; 0: two voxels")}},
  };
  return shapes;
}

std::string read_shape_name(const YamlNode& node, const std::string& field) {
  std::vector<std::string> names;
  for (const auto& [name, parameters] : shape_parameters()) names.push_back(name);
  if (node.kind != YamlNode::Kind::kMap) {
    refuse_value(node, field, "a map with a name, a shape and its size");
  }
  const YamlNode* shape = node.find("shape");
  if (shape == nullptr) {
    throw InputError(fmt::format("{}: {}: 'shape' is missing; give one of {}", node.place().text(),
                                 field, fmt::join(names, ", ")));
  }
  const std::string text = read_text(*shape, field + ".shape");
  if (shape_parameters().count(text) == 0) {
    throw InputError(shape->place().text() + ": " + field +
                     ".shape: " + unknown_name_message("shape", text, names));
  }
  return text;
}

void read_size(const YamlMap& map, const PackageResolver& resolver, ObstacleSpec& obstacle) {
  if (obstacle.shape == "sphere" || obstacle.shape == "capsule" || obstacle.shape == "cylinder") {
    obstacle.radius = map.number("radius");
  }
  if (obstacle.shape == "capsule" || obstacle.shape == "cylinder") {
    obstacle.length = map.number("length");
  }
  if (obstacle.shape == "box") {
    obstacle.size = map.vector("size");
    if (!(obstacle.size.minCoeff() >= kMinShapeSize)) {
      refuse_value(*map.find("size"), map.field("size"),
                   fmt::format("three extents >= {:g} m", kMinShapeSize));
    }
  }
  if (obstacle.shape == "mesh") {
    const YamlNode& path = map.require("mesh", "the path of a mesh file");
    obstacle.mesh_path = read_path(path, map.field("mesh"), resolver);
    obstacle.scale = map.number("scale");
    obstacle.voxel_size = map.number("voxel_size");
    obstacle.collider = find_collider(map.text("collider"));
    obstacle.thickness = map.number("thickness");
  }
}

ObstacleSpec read_obstacle(const YamlNode& node, const std::string& field,
                           const FiniteCheck& limits, std::vector<std::string>& names,
                           const PackageResolver& resolver) {
  ObstacleSpec obstacle;
  obstacle.place = node.place();
  obstacle.shape = read_shape_name(node, field);
  const std::vector<ParameterSpec> specs =
      joined(pose_parameters(limits),
             joined(shape_parameters().at(obstacle.shape), obstacle_parameters()));
  std::vector<std::string> others = {"name", "shape", "color"};
  if (obstacle.shape == "mesh") others.emplace_back("mesh");
  const YamlMap map(node, field, specs, others);
  obstacle.name = read_unique_name(map, names);
  read_size(map, resolver, obstacle);
  obstacle.world_from_shape = read_pose(map);
  obstacle.friction = map.optional_number("friction");
  obstacle.temperature = map.optional_number("temperature");
  obstacle.liquid = map.flag("liquid");
  if (const YamlNode* color = map.find("color")) {
    obstacle.color = read_color(*color, map.field("color"), 4);
  }
  return obstacle;
}

}  // namespace

std::vector<ParameterSpec> obstacle_parameters() {
  return {friction_parameter(), temperature_parameter(),
          flag_parameter("liquid", "false",
                         "bodies pass into it, and cloth in it gets wet (effect wetness)")};
}

std::vector<ParameterSpec> robot_parameters() {
  return {friction_parameter(), temperature_parameter()};
}

std::vector<ObstacleSpec> read_obstacles(const YamlNode& list, const FiniteCheck& limits,
                                         const PackageResolver& resolver) {
  std::vector<ObstacleSpec> obstacles;
  std::vector<std::string> names;
  const auto& items = read_list(list, "obstacles", "a list of obstacles");
  for (std::size_t i = 0; i < items.size(); ++i) {
    obstacles.push_back(
        read_obstacle(items[i], fmt::format("obstacles[{}]", i), limits, names, resolver));
  }
  return obstacles;
}

namespace {

/// The entries of a map of names and numbers; `what` they are.
std::map<std::string, RobotSpec::NamedValue> read_named_values(const YamlMap& map,
                                                               const std::string& key,
                                                               const std::string& what) {
  std::map<std::string, RobotSpec::NamedValue> values;
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

}  // namespace

namespace {

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

}  // namespace

RobotSpec read_robot(const YamlNode& node, const FiniteCheck& limits,
                     const PackageResolver& resolver) {
  const YamlMap map(node, "robot", joined(pose_parameters(limits), robot_parameters()),
                    {"urdf", "keyframes", "initial", "link_temperatures", "colliders"});
  RobotSpec robot;
  robot.place = node.place();
  if (const YamlNode* urdf = map.find("urdf")) {
    robot.urdf_path = read_path(*urdf, "robot.urdf", resolver);
  }
  if (const YamlNode* keyframes = map.find("keyframes")) {
    robot.keyframes_path = read_path(*keyframes, "robot.keyframes", resolver);
    robot.keyframes_place = keyframes->place();
  }
  if (const YamlNode* colliders = map.find("colliders")) {
    robot.colliders = read_colliders(*colliders, "robot.colliders");
    robot.colliders_place = colliders->place();
  }
  robot.world_from_base = read_pose(map);
  robot.friction = map.optional_number("friction");
  robot.temperature = map.optional_number("temperature");
  robot.initial = read_named_values(map, "initial", "a map of joints and their positions");
  robot.link_temperatures =
      read_named_values(map, "link_temperatures", "a map of links and their temperatures [K]");
  const ParameterSpec allowed = temperature_parameter();
  for (const auto& [link, temperature] : robot.link_temperatures) {
    if (temperature.value >= allowed.min && temperature.value <= allowed.max) continue;
    throw InputError(fmt::format("{}: robot.link_temperatures.{} is {:g}, but must be {}",
                                 temperature.place.text(), link, temperature.value,
                                 allowed.range_text()));
  }
  return robot;
}

}  // namespace pliant
