#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <limits>

#include "pliant/math/error.h"
#include "pliant/scene/reading/scene_readers.h"
#include "pliant/scene/yaml/scene_formats.h"

namespace pliant {
namespace {

struct Corner {
  const char* name;
  bool right;
  bool top;
};
constexpr std::array<Corner, 4> kCorners = {{{"lower_left", false, false},
                                             {"lower_right", true, false},
                                             {"upper_left", false, true},
                                             {"upper_right", true, true}}};

std::vector<std::string> corner_names() {
  std::vector<std::string> names;
  for (const Corner& corner : kCorners) names.emplace_back(corner.name);
  return names;
}

std::vector<ParameterSpec> box_parameters() {
  const double infinity = std::numeric_limits<double>::infinity();
  return {vector_parameter("min", "m", "", infinity, "lowest corner"),
          vector_parameter("max", "m", "", infinity, "highest corner")};
}

std::vector<ParameterSpec> sphere_parameters() {
  return {
      vector_parameter("center", "m", "", std::numeric_limits<double>::infinity(), "of the sphere"),
      positive_parameter("radius", "m", "", 1e9, "of the sphere")};
}

void read_corner(const YamlNode& node, const std::string& field, RegionSpec& region) {
  const std::string text = read_text(node, field);
  for (const Corner& corner : kCorners) {
    if (text != corner.name) continue;
    region.corner_right = corner.right;
    region.corner_top = corner.top;
    return;
  }
  throw InputError(node.place().text() + ": " + field + ": " +
                   unknown_name_message("corner", text, corner_names()));
}

Eigen::AlignedBox3d read_box(const YamlNode& node, const std::string& field) {
  const YamlMap map(node, field, box_parameters());
  if ((map.vector("min").array() > map.vector("max").array()).any()) {
    throw InputError(fmt::format("{}: {} has a 'min' above its 'max'", node.place().text(), field));
  }
  return {map.vector("min"), map.vector("max")};
}

void read_vertices(const YamlNode& node, const std::string& field, RegionSpec& region) {
  region.kind = RegionSpec::Kind::kVertices;
  const std::string expected = "a list of vertex indices (whole numbers >= 0)";
  const double last = static_cast<double>(kMaxVertices - 1);
  for (double index :
       read_numbers(node, field, 1, static_cast<int>(kMaxVertices), 0.0, last, expected)) {
    if (index != std::floor(index)) refuse_value(node, field, expected);
    region.vertices.push_back(static_cast<int>(index));
  }
}

void read_sphere(const YamlNode& node, const std::string& field, RegionSpec& region) {
  region.kind = RegionSpec::Kind::kSphere;
  const YamlMap map(node, field, sphere_parameters());
  region.center = map.vector("center");
  region.radius = map.number("radius");
}

}  // namespace

std::vector<SceneFormat> region_formats() {
  return {{"Regions",
           "Which vertices of a body are meant: under `fixed:` a list of maps, each with one of "
           "these keys; under `attachments:` one of them stands in each item. Boxes and spheres "
           "are in the world, where the body starts (of an attachment with `from`, where it is "
           "then); one that holds no vertex is refused",
           {{"corner", fmt::format("one of {}", fmt::join(corner_names(), ", ")),
             "of a grid alone, as it lies before it is placed: x to the right, y up"},
            {"vertices", "a list of whole numbers >= 0", "indices of vertices"},
            {"box", "a map with `min` and `max`", "vertices within it"},
            {"sphere", "a map with `center` and `radius`", "vertices within it"}},
           {},
           "fixed:\n"
           "  - {corner: upper_left}\n"
           "  - {box: {min: [-0.1, -0.1, 0.0], max: [0.1, 0.1, 0.05]}}\n"
           "attachments:\n"
           "  - {name: held, sphere: {center: [0, 0, 0.3], radius: 0.02}, to: palm, stiffness: "
           "500}\n"},
          {"Region `box`", "A map under `box:`", {}, box_parameters()},
          {"Region `sphere`", "A map under `sphere:`", {}, sphere_parameters()}};
}

const std::vector<std::string>& region_keys() {
  static const std::vector<std::string> keys = {"corner", "vertices", "box", "sphere"};
  return keys;
}

RegionSpec read_region(const YamlMap& map, bool is_grid) {
  int given = 0;
  for (const std::string& key : region_keys()) given += map.has(key) ? 1 : 0;
  if (given != 1) {
    throw InputError(fmt::format("{}: {} needs one of {}", map.place().text(), map.name(),
                                 fmt::join(region_keys(), ", ")));
  }
  RegionSpec region;
  region.place = map.place();
  if (const YamlNode* corner = map.find("corner")) {
    if (!is_grid) {
      throw InputError(
          fmt::format("{}: {} is for grids; for a mesh give 'vertices', 'box' or 'sphere'",
                      corner->place().text(), map.field("corner")));
    }
    region.kind = RegionSpec::Kind::kCorner;
    read_corner(*corner, map.field("corner"), region);
  } else if (const YamlNode* vertices = map.find("vertices")) {
    read_vertices(*vertices, map.field("vertices"), region);
  } else if (const YamlNode* sphere = map.find("sphere")) {
    read_sphere(*sphere, map.field("sphere"), region);
  } else {
    region.kind = RegionSpec::Kind::kBox;
    region.box = read_box(*map.find("box"), map.field("box"));
  }
  return region;
}

}  // namespace pliant
