#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <limits>

#include "pliant/math/error.h"
#include "pliant/models/registry.h"
#include "pliant/scene/geometry_kinds.h"
#include "pliant/scene/place_error.h"
#include "pliant/scene/scene_readers.h"

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

void read_corner(const YamlNode& node, const std::string& field, FixedSpec& fixed) {
  const std::string text = read_text(node, field);
  std::vector<std::string> names;
  for (const Corner& corner : kCorners) {
    names.emplace_back(corner.name);
    if (text != corner.name) continue;
    fixed.corner_right = corner.right;
    fixed.corner_top = corner.top;
    return;
  }
  throw InputError(node.place().text() + ": " + field + ": " +
                   unknown_name_message("corner", text, names));
}

Eigen::AlignedBox3d read_box(const YamlNode& node, const std::string& field) {
  const double infinity = std::numeric_limits<double>::infinity();
  const YamlMap map(node, field,
                    {vector_parameter("min", "m", "", infinity, "lowest corner"),
                     vector_parameter("max", "m", "", infinity, "highest corner")});
  if ((map.vector("min").array() > map.vector("max").array()).any()) {
    throw InputError(fmt::format("{}: {} has a 'min' above its 'max'", node.place().text(), field));
  }
  return {map.vector("min"), map.vector("max")};
}

FixedSpec read_fixed(const YamlNode& node, const std::string& field, bool is_grid) {
  const YamlMap map(node, field, {}, {"corner", "vertices", "box"});
  if (node.entries.size() != 1) {
    throw InputError(
        fmt::format("{}: {} needs one of corner, vertices, box", node.place().text(), field));
  }
  FixedSpec fixed;
  fixed.place = node.place();
  if (const YamlNode* corner = map.find("corner")) {
    if (!is_grid) {
      throw InputError(fmt::format("{}: {} is for grids; for a mesh give 'vertices' or 'box'",
                                   corner->place().text(), map.field("corner")));
    }
    fixed.kind = FixedSpec::Kind::kCorner;
    read_corner(*corner, map.field("corner"), fixed);
  } else if (const YamlNode* vertices = map.find("vertices")) {
    fixed.kind = FixedSpec::Kind::kVertices;
    const std::string expected = "a list of vertex indices (whole numbers >= 0)";
    const double last = static_cast<double>(kMaxVertices - 1);
    for (double index : read_numbers(*vertices, map.field("vertices"), 1,
                                     static_cast<int>(kMaxVertices), 0.0, last, expected)) {
      if (index != std::floor(index)) refuse_value(*vertices, map.field("vertices"), expected);
      fixed.vertices.push_back(static_cast<int>(index));
    }
  } else {
    fixed.kind = FixedSpec::Kind::kBox;
    fixed.box = read_box(*map.find("box"), map.field("box"));
  }
  return fixed;
}

NamedParameters read_model(const YamlMap& body) {
  const YamlNode& node = body.require("model", "the name of a model");
  NamedParameters model;
  model.name = read_text(node, body.field("model"));
  const auto& entry = with_place(
      node.place().text() + ": " + body.field("model"), [&]() -> auto& {
        return model_registry().find(model.name);
      });
  const std::string field = body.field("material");
  const YamlNode* material = body.find("material");
  YamlNode none;
  none.file = node.file;
  none.line = node.line;
  const YamlNode& given = material == nullptr ? none : *material;
  model.parameters = read_parameters(given, field, entry.parameters);
  model.where = given.place().text() + ": " + field;
  return model;
}

BodySpec read_body(const YamlNode& node, const std::string& field, const FiniteCheck& limits,
                   std::vector<std::string>& names, const PackageResolver& resolver) {
  const YamlMap map(
      node, field,
      joined(pose_parameters(limits),
             {vector_parameter("velocity", "m/s", "[0, 0, 0]", limits.max_speed, "at the start")}),
      {"name", "model", "geometry", "material", "fixed", "color"});
  BodySpec body;
  body.place = node.place();
  body.name = read_unique_name(map, names);
  body.model = read_model(map);
  const std::string kinds = fmt::format("{}", fmt::join(geometry_names(body.model.name), ", "));
  body.geometry = read_geometry(map.require("geometry", "a map with one of " + kinds),
                                map.field("geometry"), body.model.name, resolver);
  body.world_from_body = read_pose(map);
  body.velocity = map.vector("velocity");
  if (const YamlNode* color = map.find("color")) {
    body.color = read_color(*color, map.field("color"), 3).head<3>();
  }
  if (const YamlNode* fixed = map.find("fixed")) {
    const auto& items = read_list(*fixed, map.field("fixed"),
                                  "a list of {corner: NAME}, {vertices: [I, ...]} or {box: ...}");
    for (std::size_t i = 0; i < items.size(); ++i) {
      body.fixed.push_back(read_fixed(items[i], fmt::format("{}[{}]", map.field("fixed"), i),
                                      body.geometry.grid.has_value()));
    }
  }
  return body;
}

}  // namespace

std::vector<BodySpec> read_bodies(const YamlNode& list, const FiniteCheck& limits,
                                  const PackageResolver& resolver) {
  std::vector<BodySpec> bodies;
  std::vector<std::string> names;
  double vertices = 0.0;
  const auto& items = read_list(list, "bodies", "a list of at least one body");
  for (std::size_t i = 0; i < items.size(); ++i) {
    bodies.push_back(read_body(items[i], fmt::format("bodies[{}]", i), limits, names, resolver));
    const auto& grid = bodies.back().geometry.grid;
    if (grid) vertices += static_cast<double>(grid->columns) * grid->rows;
  }
  if (vertices > static_cast<double>(kMaxVertices)) {
    throw InputError(
        fmt::format("{}: bodies have {:.0f} vertices together, but at most {} are "
                    "allowed",
                    list.place().text(), vertices, kMaxVertices));
  }
  return bodies;
}

}  // namespace pliant
