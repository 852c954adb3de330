#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/math/error.h"
#include "pliant/scene/reading/obstacle_parameters.h"
#include "pliant/scene/reading/scene_readers.h"

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

}  // namespace pliant
