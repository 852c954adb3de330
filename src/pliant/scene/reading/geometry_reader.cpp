#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "pliant/math/error.h"
#include "pliant/scene/reading/geometry_kinds.h"
#include "pliant/scene/reading/scene_readers.h"

namespace pliant {
namespace {

constexpr double kMaxGridSize = 1e6;  // [m]

GridOptions read_grid(const YamlNode& node, const std::string& field) {
  const YamlMap map(node, field, {}, {"size", "vertices"});
  const std::string size_text = "two numbers > 0 [width, height] in m";
  const std::string count_text = fmt::format(
      "two whole numbers >= 2 [columns, rows] that make at most {} triangles, two a cell",
      kMaxTriangles);
  const std::vector<double> size = read_numbers(map.require("size", size_text), map.field("size"),
                                                2, 2, 1e-6, kMaxGridSize, size_text);
  const YamlNode& vertices = map.require("vertices", count_text);
  const std::vector<double> count = read_numbers(vertices, map.field("vertices"), 2, 2, 2.0,
                                                 0.5 * kMaxTriangles + 1.0, count_text);
  for (double number : count) {
    if (number != std::floor(number)) refuse_value(vertices, map.field("vertices"), count_text);
  }
  const double triangles = 2.0 * (count[0] - 1.0) * (count[1] - 1.0);
  if (triangles > kMaxTriangles) {
    const double side = std::floor(std::sqrt(0.5 * kMaxTriangles)) + 1.0;
    throw InputError(fmt::format(
        "{}: {} makes {:.0f} vertices and {:.0f} triangles, but at most {} triangles are allowed, "
        "as [{:.0f}, {:.0f}] makes",
        vertices.place().text(), map.field("vertices"), count[0] * count[1], triangles,
        kMaxTriangles, side, side));
  }
  return {size[0], size[1], static_cast<int>(count[0]), static_cast<int>(count[1])};
}

/// The one key of the map that names a kind.
std::string read_kind(const YamlNode& node, const std::string& field, const std::string& model) {
  const std::vector<std::string> names = geometry_names(model);
  if (node.kind != YamlNode::Kind::kMap) {
    refuse_value(node, field, fmt::format("a map with one of {}", fmt::join(names, ", ")));
  }
  std::string found;
  for (const std::string& name : names) {
    if (node.find(name) == nullptr) continue;
    if (!found.empty()) {
      throw InputError(fmt::format("{}: {} has '{}' and '{}'; give one", node.place().text(), field,
                                   found, name));
    }
    found = name;
  }
  if (!found.empty()) return found;
  for (const GeometryKind& kind : geometry_kinds()) {
    if (const YamlNode* other = node.find(kind.name)) {
      throw InputError(fmt::format("{}: {}: '{}' does not work for model '{}'; these do: {}",
                                   other->place().text(), field, kind.name, model,
                                   fmt::join(names, ", ")));
    }
  }
  std::string meant;
  for (const YamlEntry& entry : node.entries) {
    if (meant.empty()) meant = nearest_name(entry.key, names);
  }
  throw InputError(fmt::format("{}: {} needs one of {}{}", node.place().text(), field,
                               fmt::join(names, ", "),
                               meant.empty() ? "" : "; did you mean '" + meant + "'?"));
}

}  // namespace

GeometrySpec read_geometry(const YamlNode& node, const std::string& field, const std::string& model,
                           const PackageResolver& resolver) {
  GeometrySpec geometry;
  geometry.place = node.place();
  geometry.kind = read_kind(node, field, model);
  const GeometryKind& kind = find_geometry_kind(geometry.kind, model);
  const YamlMap map(node, field, kind.options, {kind.name});
  const YamlNode& size = *map.find(kind.name);
  geometry.options = map.values();
  if (kind.name == "grid") {
    geometry.grid = read_grid(size, map.field("grid"));
  } else if (kind.size.empty()) {
    geometry.path = read_path(size, map.field(kind.name), resolver);
  } else {
    const ParameterText text = read_parameters(size, map.field(kind.name), kind.size);
    geometry.size =
        parse_parameters(kind.size, text, size.place().text() + ": " + map.field(kind.name));
  }
  return geometry;
}

}  // namespace pliant
