#include "pliant/scene/yaml/yaml_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "pliant/math/error.h"

namespace pliant {
namespace {

std::vector<std::string> names_of(const std::vector<ParameterSpec>& specs) {
  std::vector<std::string> names;
  for (const ParameterSpec& spec : specs) names.push_back(spec.name);
  return names;
}

std::string beginning(const SourcePlace& place, const std::string& field) {
  return field.empty() ? place.text() : place.text() + ": " + field;
}

/// Each value by itself first, so that the message has its own line; then all, for missing ones.
Parameters check_values(const YamlNode& node, const std::string& field,
                        const std::vector<ParameterSpec>& specs, ParameterText& text) {
  for (const ParameterSpec& spec : specs) {
    const YamlNode* value = node.find(spec.name);
    if (value == nullptr) continue;
    text[spec.name] = parameter_text(*value, YamlMap::child_field(field, spec.name));
    parse_parameters({spec}, {{spec.name, text[spec.name]}}, beginning(value->place(), field));
  }
  return parse_parameters(specs, text, beginning(node.place(), field));
}

/// Throws InputError at the first key that is neither of `specs` nor of `others`; for a former name
/// it says the present one.
void check_names(const YamlNode& node, const std::string& field,
                 const std::vector<ParameterSpec>& specs, const std::vector<std::string>& others) {
  for (const YamlEntry& entry : node.entries) {
    const ParameterSpec* spec = find_renamed(specs, entry.key);
    if (spec == nullptr) continue;
    throw InputError(fmt::format("{}: the key '{}' in {} is called '{}' now",
                                 entry.key_place.text(), entry.key,
                                 field.empty() ? "the file" : field, spec->name));
  }
  std::vector<std::string> allowed = names_of(specs);
  allowed.insert(allowed.end(), others.begin(), others.end());
  check_keys(node, field, allowed);
}

}  // namespace

YamlMap::YamlMap(const YamlNode& node, std::string field, const std::vector<ParameterSpec>& specs,
                 const std::vector<std::string>& others)
    : node_(node), field_(std::move(field)) {
  check_names(node_, field_, specs, others);
  ParameterText text;
  values_ = check_values(node_, field_, specs, text);
}

std::optional<double> YamlMap::optional_number(const std::string& key) const {
  if (!has(key)) return std::nullopt;
  return number(key);
}

const YamlNode& YamlMap::require(const std::string& key, const std::string& expected) const {
  const YamlNode* found = find(key);
  if (found != nullptr) return *found;
  throw InputError(
      fmt::format("{}: '{}' is missing; give {}", beginning(place(), field_), key, expected));
}

std::string YamlMap::child_field(const std::string& field, const std::string& key) {
  return field.empty() ? key : field + "." + key;
}

void refuse_value(const YamlNode& node, const std::string& field, const std::string& expected) {
  throw InputError(fmt::format("{}: {} is {}, but must be {}", node.place().text(), field,
                               node.described(), expected));
}

void check_keys(const YamlNode& node, const std::string& field,
                const std::vector<std::string>& allowed) {
  if (node.kind != YamlNode::Kind::kMap) {
    refuse_value(node, field, fmt::format("a map with some of {}", fmt::join(allowed, ", ")));
  }
  for (const YamlEntry& entry : node.entries) {
    if (std::find(allowed.begin(), allowed.end(), entry.key) != allowed.end()) continue;
    const std::string nearest = nearest_name(entry.key, allowed);
    throw InputError(fmt::format("{}: unknown key '{}' in {}; {}{}", entry.key_place.text(),
                                 entry.key, field.empty() ? "the file" : field,
                                 allowed.empty()
                                     ? "none is allowed"
                                     : fmt::format("allowed are {}", fmt::join(allowed, ", ")),
                                 nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
}

std::string parameter_text(const YamlNode& node, const std::string& field) {
  const std::string expected = "a number, a text, true, false or a list of numbers";
  if (node.kind == YamlNode::Kind::kScalar) return node.text;
  if (node.kind != YamlNode::Kind::kList) refuse_value(node, field, expected);
  std::vector<std::string> words;
  for (const YamlNode& item : node.items) {
    // The parser of lists would take "1 2" for two numbers.
    const bool one_word = item.kind == YamlNode::Kind::kScalar &&
                          item.text.find_first_of(" \t\n,[]") == std::string::npos;
    if (!one_word) refuse_value(item, field, "a list of numbers");
    words.push_back(item.text);
  }
  return fmt::format("[{}]", fmt::join(words, ", "));
}

ParameterText read_parameters(const YamlNode& node, const std::string& field,
                              const std::vector<ParameterSpec>& specs,
                              const std::vector<std::string>& skip) {
  ParameterText text;
  if (node.kind == YamlNode::Kind::kNull) {
    parse_parameters(specs, text, beginning(node.place(), field));
    return text;
  }
  check_names(node, field, specs, skip);
  check_values(node, field, specs, text);
  return text;
}

std::string read_text(const YamlNode& node, const std::string& field) {
  if (node.kind != YamlNode::Kind::kScalar || node.text.empty()) {
    refuse_value(node, field, "a text");
  }
  return node.text;
}

std::string read_name(const YamlNode& node, const std::string& field) {
  constexpr std::size_t kLongest = 64;
  const auto is_allowed = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
  };
  const bool fits = node.kind == YamlNode::Kind::kScalar && !node.text.empty() &&
                    node.text.size() <= kLongest &&
                    std::all_of(node.text.begin(), node.text.end(), is_allowed);
  if (!fits) refuse_value(node, field, "a name of 1 to 64 letters, digits, '_' or '-'");
  return node.text;
}

const std::vector<YamlNode>& read_list(const YamlNode& node, const std::string& field,
                                       const std::string& expected) {
  if (node.kind != YamlNode::Kind::kList || node.items.empty()) {
    refuse_value(node, field, expected);
  }
  return node.items;
}

std::vector<double> read_numbers(const YamlNode& node, const std::string& field, int least,
                                 int most, double min, double max, const std::string& expected) {
  const std::vector<YamlNode>& items = read_list(node, field, expected);
  const int count = static_cast<int>(items.size());
  if (count < least || count > most) {
    throw InputError(fmt::format("{}: {} has {} items, but must be {}", node.place().text(), field,
                                 count, expected));
  }
  std::vector<double> numbers;
  for (const YamlNode& item : items) {
    if (item.kind != YamlNode::Kind::kScalar) refuse_value(item, field, expected);
    const double number = parse_number(item.text, item.place().text() + ": " + field);
    if (!(number >= min && number <= max)) refuse_value(item, field, expected);
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace pliant
