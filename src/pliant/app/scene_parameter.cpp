#include "pliant/app/scene_parameter.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>

#include "pliant/effects/registry.h"
#include "pliant/math/error.h"
#include "pliant/models/registry.h"
#include "pliant/scene/reading/obstacle_parameters.h"

namespace pliant {
namespace {

/// A list's item by its number or its name.
template <class Item>
const Item& item_of(const std::vector<Item>& items, const std::string& key, const char* kind,
                    const std::string& path) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < items.size(); ++k) {
    if (items[k].name == key || std::to_string(k) == key) return items[k];
    names.push_back(items[k].name);
  }
  throw InputError(path + ": " + unknown_name_message(kind, key, names));
}

SceneParameter parameter_of(const std::vector<ParameterSpec>& specs, const ParameterText& texts,
                            const std::string& name, const std::string& path) {
  std::vector<std::string> numbers;
  for (const ParameterSpec& spec : specs) {
    if (spec.type != ParameterType::kNumber) continue;
    numbers.push_back(spec.name);
    if (spec.name != name) continue;
    const auto found = texts.find(name);
    const std::string& text = found == texts.end() ? spec.default_value : found->second;
    return {text.empty() ? std::max(spec.min, 0.0) : parse_number(text, path), spec};
  }
  throw InputError(path + ": " + unknown_name_message("number", name, numbers));
}

SceneParameter effect_parameter(const SceneSpec& scene, const std::string& effect,
                                const std::string& name, const std::string& path) {
  const NamedParameters& own = item_of(scene.effects, effect, "effect of the scene", path);
  return parameter_of(effect_registry().find(own.name).parameters, own.parameters, name, path);
}

}  // namespace

std::optional<SceneParameter> scene_parameter(const SceneSpec& scene, const std::string& path) {
  static const std::regex material(R"(bodies\[([^\]]+)\]\.material\.(\w+))");
  static const std::regex effect(R"(effects\.(\w+)\.(\w+))");
  static const std::regex obstacle(R"(obstacles\[([^\]]+)\]\.(friction))");
  std::smatch parts;
  if (std::regex_match(path, parts, material)) {
    const BodySpec& body = item_of(scene.bodies, parts[1], "body", path);
    return parameter_of(model_registry().find(body.model.name).parameters, body.model.parameters,
                        parts[2], path);
  }
  if (std::regex_match(path, parts, effect)) {
    return effect_parameter(scene, parts[1], parts[2], path);
  }
  if (std::regex_match(path, parts, obstacle)) {
    const ObstacleSpec& own = item_of(scene.obstacles, parts[1], "obstacle", path);
    SceneParameter found = parameter_of(obstacle_parameters(), {}, parts[2], path);
    if (own.friction) found.value = *own.friction;
    return found;
  }
  return {};
}

}  // namespace pliant
