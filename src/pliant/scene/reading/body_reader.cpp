#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/math/error.h"
#include "pliant/models/registry.h"
#include "pliant/models/solver_registry.h"
#include "pliant/scene/reading/fabrics.h"
#include "pliant/scene/reading/geometry_kinds.h"
#include "pliant/scene/reading/scene_readers.h"
#include "pliant/scene/yaml/place_error.h"
#include "pliant/solvers/time/time_integrations.h"

namespace pliant {
namespace {

/// What the material says, and what its fabric says of the rest.
ParameterText read_fabric_material(const YamlNode& material, const YamlNode& fabric,
                                   const std::string& field,
                                   const std::vector<ParameterSpec>& specs) {
  const std::string name = read_text(fabric, field + ".fabric");
  const Fabric& found = with_place(
      fabric.place().text() + ": " + field + ".fabric", [&]() -> auto& {
        return find_fabric(name);
      });
  ParameterText parameters = found.parameters;
  const ParameterText own = read_parameters(material, field, specs, {"fabric"});
  // One stiffness for both directions says more than the fabric's two.
  if (own.count("bending") > 0) {
    parameters.erase("bending_warp");
    parameters.erase("bending_weft");
  }
  for (const auto& [key, value] : own) parameters[key] = value;
  return parameters;
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
  const YamlNode* fabric = given.find("fabric");
  if (fabric == nullptr || model.name != "cloth") {
    model.parameters = read_parameters(given, field, entry.parameters);
  } else {
    model.parameters = read_fabric_material(given, *fabric, field, entry.parameters);
  }
  model.where = given.place().text() + ": " + field;
  return model;
}

BodySpec read_body(const YamlNode& node, const std::string& field, const FiniteCheck& limits,
                   std::vector<std::string>& names, const PackageResolver& resolver) {
  const YamlMap map(
      node, field,
      joined(pose_parameters(limits),
             {vector_parameter("velocity", "m/s", "[0, 0, 0]", limits.max_speed, "at the start")}),
      {"name", "model", "geometry", "material", "fixed", "attachments", "color", "solver",
       "time_integration"});
  BodySpec body;
  body.place = node.place();
  body.name = read_unique_name(map, names);
  body.model = read_model(map);
  const std::string kinds = fmt::format("{}", fmt::join(geometry_names(body.model.name), ", "));
  body.geometry = read_geometry(map.require("geometry", "a map with one of " + kinds),
                                map.field("geometry"), body.model.name, resolver);
  const bool is_grid = body.geometry.grid.has_value();
  body.world_from_body = read_pose(map);
  body.velocity = map.vector("velocity");
  if (const YamlNode* color = map.find("color")) {
    body.color = read_color(*color, map.field("color"), 3).head<3>();
  }
  if (const YamlNode* fixed = map.find("fixed")) {
    const auto& items = read_list(*fixed, map.field("fixed"),
                                  "a list of {corner: NAME}, {vertices: [I, ...]}, {box: ...} or "
                                  "{sphere: ...}");
    for (std::size_t i = 0; i < items.size(); ++i) {
      const YamlMap item(items[i], fmt::format("{}[{}]", map.field("fixed"), i), {}, region_keys());
      body.fixed.push_back(read_region(item, is_grid));
    }
  }
  if (const YamlNode* list = map.find("attachments")) {
    body.attachments = read_attachments(*list, map.field("attachments"), is_grid);
  }
  if (const YamlNode* solver = map.find("solver")) {
    body.solver = read_solver(*solver, map.field("solver"));
    with_place(body.solver->where,
               [&] { all_solvers().find_for(body.solver->name, body.model.name); });
  }
  if (const YamlNode* integration = map.find("time_integration")) {
    body.time_integration = read_time_integration(*integration, map.field("time_integration"));
    with_place(body.time_integration->where,
               [&] { time_integrations().find_for(body.time_integration->name, body.model.name); });
  }
  return body;
}

/// Vertices or particles that it will have at least, as far as they are known before it is made.
double least_points(const BodySpec& body) {
  const GeometrySpec& geometry = body.geometry;
  if (geometry.grid) return static_cast<double>(geometry.grid->columns) * geometry.grid->rows;
  const GeometryKind& kind = find_geometry_kind(geometry.kind, body.model.name);
  return kind.least_points ? kind.least_points(geometry.size, geometry.options) : 0.0;
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
    vertices += least_points(bodies.back());
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
