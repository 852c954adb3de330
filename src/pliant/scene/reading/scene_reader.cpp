#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "pliant/effects/registry.h"
#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"
#include "pliant/scene/file_access.h"
#include "pliant/scene/reading/scene_readers.h"
#include "pliant/scene/scene.h"
#include "pliant/scene/yaml/place_error.h"
#include "pliant/scene/yaml/yaml_include.h"
#include "pliant/solvers/time/time_integrations.h"

namespace pliant {
namespace {

constexpr int kMaxThreads = 256;

std::vector<ParameterSpec> scene_parameters() {
  return {positive_parameter("time_step", "s", "", 1.0, "of every body"),
          integer_parameter("threads", "1", 1, kMaxThreads,
                            "that a step may use; where none are named, `pliant run` and nodes "
                            "take 2 if the machine has them")};
}

FiniteCheck read_limits(const YamlNode& node) {
  const YamlMap map(
      node, "limits",
      {positive_parameter("max_speed", "m/s", "1e4", 3e8, "a faster vertex is an error"),
       positive_parameter("max_distance", "m", "1e6", 1e9,
                          "a vertex further from the origin is an error")});
  FiniteCheck limits;
  limits.max_speed = map.number("max_speed");
  limits.max_distance = map.number("max_distance");
  return limits;
}

RecordingSpec read_recording(const YamlNode& node) {
  const YamlMap map(node, "recording",
                    {integer_parameter("every", "", 1, 1e9, "a surface frame each so many steps"),
                     choice_parameter("format", "ply", {"ply", "obj"}, "of the frames")});
  RecordingSpec recording;
  recording.every = map.integer("every");
  recording.format = map.text("format") == "obj" ? FrameFormat::kObj : FrameFormat::kPly;
  return recording;
}

std::optional<NamedParameters> read_gravity(const YamlMap& scene, const YamlNode* effects) {
  const YamlNode* gravity = scene.find("gravity");
  if (gravity == nullptr) return std::nullopt;
  if (const YamlNode* other = effects == nullptr ? nullptr : effects->find("gravity")) {
    throw InputError(fmt::format("{}: 'gravity' is given here and in 'effects' ({}); give one",
                                 gravity->place().text(), other->place().text()));
  }
  NamedParameters named;
  named.name = "gravity";
  named.where = gravity->place().text() + ": gravity";
  named.parameters = {{"acceleration", parameter_text(*gravity, "gravity")}};
  const auto& entry = effect_registry().find("gravity");
  parse_parameters(entry.parameters, named.parameters, named.where);
  return named;
}

SceneNames names_of(const SceneSpec& spec) {
  SceneNames names;
  for (const BodySpec& body : spec.bodies) names.bodies.push_back(body.name);
  for (const ObstacleSpec& obstacle : spec.obstacles) names.obstacles.push_back(obstacle.name);
  return names;
}

/// The bodies that an effect names; empty where it names none.
std::vector<std::string> read_acted_on(const YamlNode& effect, const std::string& field,
                                       const EffectRegistry::Entry& entry,
                                       const std::vector<BodySpec>& bodies) {
  const YamlNode* node = effect.find("bodies");
  if (node == nullptr) return {};
  std::vector<std::string> known, named;
  for (const BodySpec& body : bodies) known.push_back(body.name);
  for (const YamlNode& item :
       read_list(*node, field + ".bodies", "a list of names of at least one body")) {
    const std::string name = read_text(item, field + ".bodies");
    const std::string where = item.place().text() + ": " + field + ".bodies: ";
    const auto body = std::find_if(bodies.begin(), bodies.end(),
                                   [&](const BodySpec& other) { return other.name == name; });
    if (body == bodies.end()) throw InputError(where + unknown_name_message("body", name, known));
    if (std::count(named.begin(), named.end(), name) > 0) {
      throw InputError(fmt::format("{}body '{}' is named twice", where, name));
    }
    if (std::count(entry.models.begin(), entry.models.end(), body->model.name) == 0) {
      throw InputError(
          fmt::format("{}effect '{}' is not made for the model '{}' of body '{}', but "
                      "for {}",
                      where, entry.name, body->model.name, name, fmt::join(entry.models, ", ")));
    }
    named.push_back(name);
  }
  return named;
}

}  // namespace

void read_effects(const YamlMap& scene, SceneSpec& spec) {
  const YamlNode* node = scene.find("effects");
  if (node != nullptr) check_keys(*node, "effects", effect_registry().names());
  const std::optional<NamedParameters> gravity = read_gravity(scene, node);
  for (const auto& entry : effect_registry().entries()) {
    if (gravity && entry.name == gravity->name) spec.effects.push_back(*gravity);
    const YamlNode* parameters = node == nullptr ? nullptr : node->find(entry.name);
    if (parameters == nullptr) continue;
    NamedParameters effect;
    const std::string field = "effects." + entry.name;
    effect.name = entry.name;
    effect.where = parameters->place().text() + ": " + field;
    const bool has_pairs = !entry.pair_parameters.empty();
    effect.parameters =
        read_parameters(*parameters, field, entry.parameters,
                        has_pairs ? body_pair_keys() : std::vector<std::string>{"bodies"});
    if (!has_pairs) effect.bodies = read_acted_on(*parameters, field, entry, spec.bodies);
    if (has_pairs) {
      spec.body_pairs = read_body_pairs(*parameters, field, names_of(spec), entry.pair_parameters);
    }
    spec.effects.push_back(std::move(effect));
  }
}

NamedParameters read_solver(const YamlNode& node, const std::string& field) {
  const std::string names = fmt::format("{}", fmt::join(all_solvers().names(), ", "));
  if (node.kind != YamlNode::Kind::kMap) {
    refuse_value(node, field, "a map with a name (one of " + names + ") and its parameters");
  }
  const YamlNode* name = node.find("name");
  if (name == nullptr) {
    throw InputError(fmt::format("{}: {}: 'name' is missing; give one of {}", node.place().text(),
                                 field, names));
  }
  NamedParameters solver;
  solver.name = read_text(*name, field + ".name");
  solver.where = node.place().text() + ": " + field;
  const auto& entry = with_place(
      fmt::format("{}: {}.name", name->place().text(), field), [&]() -> auto& {
        return find_solver(solver.name);
      });
  solver.parameters = read_parameters(node, field, entry.parameters, {"name"});
  return solver;
}

NamedParameters read_time_integration(const YamlNode& node, const std::string& field) {
  NamedParameters integration;
  integration.where = node.place().text() + ": " + field;
  integration.name = read_text(node, field);
  with_place(integration.where, [&] { time_integrations().find(integration.name); });
  return integration;
}

SceneSpec read_scene(const std::string& path, const PackageResolver& resolver,
                     const std::vector<SceneValue>& values, const std::string* text) {
  const SceneFolder folder(path);
  YamlNode root = read_yaml_with_includes(path, resolver, text);
  for (const SceneValue& value : values) set_value(value, root);
  const YamlMap map(root, "", scene_parameters(),
                    {"name", "description", "bodies", "obstacles", "robot", "effects", "gravity",
                     "solver", "time_integration", "recording", "limits"});
  SceneSpec spec;
  spec.path = path;
  spec.name = std::filesystem::path(path).stem().string();
  if (const YamlNode* name = map.find("name")) spec.name = read_text(*name, "name");
  if (const YamlNode* text = map.find("description")) {
    spec.description = read_text(*text, "description");
  }
  spec.time_step = map.number("time_step");
  if (map.has("threads")) spec.threads = map.integer("threads");
  if (const YamlNode* limits = map.find("limits")) spec.limits = read_limits(*limits);
  spec.bodies =
      read_bodies(map.require("bodies", "a list of at least one body"), spec.limits, resolver);
  if (const YamlNode* obstacles = map.find("obstacles")) {
    spec.obstacles = read_obstacles(*obstacles, spec.limits, resolver);
  }
  if (const YamlNode* robot = map.find("robot")) {
    spec.robots = read_robots(*robot, spec.limits, resolver);
  }
  read_effects(map, spec);
  const YamlNode* solver = map.find("solver");
  spec.names_solver = solver != nullptr;
  if (solver != nullptr) {
    spec.solver = read_solver(*solver, "solver");
  } else {
    const std::string& model = spec.bodies.front().model.name;
    const DefaultSolver chosen = default_solver_among(model, {model}, true);
    spec.solver = {chosen.name, chosen.parameters, path};
  }
  if (const YamlNode* node = map.find("time_integration")) {
    spec.time_integration = read_time_integration(*node, "time_integration");
  }
  if (const YamlNode* node = map.find("recording")) spec.recording = read_recording(*node);
  return spec;
}

}  // namespace pliant
