// What a scene says of pairs of bodies, under an effect that acts between bodies.
#include <fmt/format.h>

#include <algorithm>

#include "pliant/math/error.h"
#include "pliant/scene/reading/scene_readers.h"

namespace pliant {
namespace {

const char* const kTwoBodies = "a list of the names of two bodies";

std::string read_body_name(const YamlNode& node, const std::string& field,
                           const SceneNames& names) {
  const std::string name = read_text(node, field);
  if (std::count(names.bodies.begin(), names.bodies.end(), name) > 0) return name;
  const std::string where = node.place().text() + ": " + field;
  if (std::count(names.obstacles.begin(), names.obstacles.end(), name) > 0) {
    throw InputError(fmt::format(
        "{}: '{}' is an obstacle: bodies touch obstacles by the effect 'contact'", where, name));
  }
  throw InputError(where + ": " + unknown_name_message("body", name, names.bodies));
}

BodyPairSpec read_two_bodies(const YamlNode& node, const std::string& field,
                             const SceneNames& names) {
  const auto& items = read_list(node, field, kTwoBodies);
  if (items.size() != 2) {
    throw InputError(fmt::format("{}: {} has {} {}, but must be {}", node.place().text(), field,
                                 items.size(), items.size() == 1 ? "item" : "items", kTwoBodies));
  }
  BodyPairSpec pair;
  pair.place = node.place();
  pair.one = read_body_name(items[0], field, names);
  pair.other = read_body_name(items[1], field, names);
  if (pair.one == pair.other) {
    throw InputError(fmt::format("{}: {} names body '{}' twice, but must be {} that differ",
                                 node.place().text(), field, pair.one, kTwoBodies));
  }
  return pair;
}

/// Refuses a pair that one of `known` names already, in either order.
void check_is_new(const BodyPairSpec& pair, const std::string& field,
                  const std::vector<BodyPairSpec>& known, const std::string& what) {
  for (const BodyPairSpec& other : known) {
    const bool is_same = (other.one == pair.one && other.other == pair.other) ||
                         (other.one == pair.other && other.other == pair.one);
    if (!is_same) continue;
    throw InputError(fmt::format("{}: {}: bodies '{}' and '{}' are {} already ({}): name them once",
                                 pair.place.text(), field, pair.one, pair.other, what,
                                 other.place.text()));
  }
}

BodyPairSpec read_pair(const YamlNode& node, const std::string& field, const SceneNames& names,
                       const std::vector<ParameterSpec>& parameters) {
  std::vector<ParameterSpec> given;
  std::vector<std::string> others = {"bodies"};
  for (const ParameterSpec& spec : parameters) {
    if (node.find(spec.name) != nullptr) {
      given.push_back(spec);
    } else {
      others.push_back(spec.name);
    }
  }
  const YamlMap map(node, field, given, others);
  BodyPairSpec pair =
      read_two_bodies(map.require("bodies", kTwoBodies), map.field("bodies"), names);
  pair.numbers.friction = map.optional_number("friction");
  pair.numbers.thickness = map.optional_number("thickness");
  return pair;
}

}  // namespace

const std::vector<std::string>& body_pair_keys() {
  static const std::vector<std::string> keys = {"pairs", "except", "only_pairs"};
  return keys;
}

BodyPairsSpec read_body_pairs(const YamlNode& effect, const std::string& field,
                              const SceneNames& names,
                              const std::vector<ParameterSpec>& parameters) {
  BodyPairsSpec spec;
  if (const YamlNode* list = effect.find("pairs")) {
    const std::string own = field + ".pairs";
    const auto& items = read_list(*list, own, "a list of {bodies: [NAME, NAME], ...}");
    for (std::size_t i = 0; i < items.size(); ++i) {
      const std::string of_item = fmt::format("{}[{}]", own, i);
      BodyPairSpec pair = read_pair(items[i], of_item, names, parameters);
      check_is_new(pair, of_item, spec.touching, "named");
      spec.touching.push_back(std::move(pair));
    }
  }
  if (const YamlNode* list = effect.find("except")) {
    const std::string own = field + ".except";
    const auto& items = read_list(*list, own, "a list of [NAME, NAME]");
    for (std::size_t i = 0; i < items.size(); ++i) {
      const std::string of_item = fmt::format("{}[{}]", own, i);
      BodyPairSpec pair = read_two_bodies(items[i], of_item, names);
      check_is_new(pair, of_item, spec.touching, "named under 'pairs'");
      check_is_new(pair, of_item, spec.left_out, "left out");
      spec.left_out.push_back(std::move(pair));
    }
  }
  if (const YamlNode* only = effect.find("only_pairs")) {
    const ParameterSpec flag = flag_parameter("only_pairs", "false", "");
    const std::string where = only->place().text() + ": " + field;
    const std::string text = parameter_text(*only, field + ".only_pairs");
    spec.only_named = parse_parameters({flag}, {{flag.name, text}}, where).flag(flag.name);
    if (spec.only_named && spec.touching.empty()) {
      throw InputError(where + ".only_pairs is true, but 'pairs' names none: nothing would touch");
    }
  }
  return spec;
}

}  // namespace pliant
