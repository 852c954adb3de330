#include "pliant/core/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "pliant/math/error.h"

namespace pliant {
namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\n");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\n") - first + 1);
}

[[noreturn]] void refuse(const ParameterSpec& spec, const std::string& text,
                         const std::string& where) {
  throw InputError(
      fmt::format("{}: '{}' is '{}', but must be {}", where, spec.name, text, spec.range_text()));
}

bool in_range(const ParameterSpec& spec, double value) {
  return (spec.min_is_allowed ? value >= spec.min : value > spec.min) && value <= spec.max;
}

Parameters::Value parse_value(const ParameterSpec& spec, const std::string& raw,
                              const std::string& where) {
  const std::string text = trimmed(raw);
  const std::string field = where + ": '" + spec.name + "'";
  switch (spec.type) {
    case ParameterType::kFlag:
      if (text == "true") return true;
      if (text == "false") return false;
      refuse(spec, text, where);
    case ParameterType::kText:
      if (!spec.choices.empty() &&
          std::find(spec.choices.begin(), spec.choices.end(), text) == spec.choices.end()) {
        throw InputError(where + ": " + unknown_name_message(spec.name, text, spec.choices));
      }
      return text;
    case ParameterType::kVector: {
      const std::vector<double> values = parse_numbers(text, field);
      if (values.size() != 3) refuse(spec, text, where);
      const Eigen::Vector3d vector(values[0], values[1], values[2]);
      if (!(vector.norm() <= spec.max)) refuse(spec, text, where);
      return vector;
    }
    case ParameterType::kInteger:
    case ParameterType::kNumber:
      break;
  }
  const double value = parse_number(text, field);
  const bool whole = spec.type == ParameterType::kNumber || value == std::floor(value);
  if (!whole || !in_range(spec, value)) refuse(spec, text, where);
  return value;
}

void check_name(const std::vector<ParameterSpec>& specs, const std::string& name,
                const std::string& where) {
  std::vector<std::string> allowed;
  for (const ParameterSpec& spec : specs) {
    if (spec.name == name) return;
    allowed.push_back(spec.name);
  }
  if (const ParameterSpec* spec = find_renamed(specs, name)) {
    throw InputError(
        fmt::format("{}: the parameter '{}' is called '{}' now", where, name, spec->name));
  }
  throw InputError(where + ": " + unknown_name_message("parameter", name, allowed));
}

}  // namespace

std::string ParameterSpec::range_text() const {
  const std::string units = unit.empty() ? "" : " [" + unit + "]";
  switch (type) {
    case ParameterType::kFlag:
      return "true or false";
    case ParameterType::kText:
      return choices.empty() ? "a text" : fmt::format("one of {}", fmt::join(choices, ", "));
    case ParameterType::kVector:
      return fmt::format("three numbers [x, y, z] of length at most {:g}{}", max, units);
    default:
      break;
  }
  const std::string kind = type == ParameterType::kInteger ? "a whole number" : "a number";
  std::string bounds;
  if (std::isfinite(min)) bounds += fmt::format(" {} {:g}", min_is_allowed ? ">=" : ">", min);
  if (std::isfinite(max)) bounds += fmt::format("{} <= {:g}", bounds.empty() ? "" : " and", max);
  return kind + bounds + units;
}

std::string describe_parameters(const std::vector<ParameterSpec>& specs) {
  std::string text;
  for (const ParameterSpec& spec : specs) {
    const std::string& value = spec.default_value.empty() ? "required" : spec.default_value;
    text += fmt::format("    {} = {}   {}\n        {}\n", spec.name, value, spec.range_text(),
                        spec.meaning);
  }
  return text;
}

ParameterSpec number_parameter(std::string name, std::string unit, std::string default_value,
                               double min, double max, std::string meaning) {
  ParameterSpec spec;
  spec.name = std::move(name);
  spec.unit = std::move(unit);
  spec.default_value = std::move(default_value);
  spec.min = min;
  spec.max = max;
  spec.meaning = std::move(meaning);
  return spec;
}

ParameterSpec positive_parameter(std::string name, std::string unit, std::string default_value,
                                 double max, std::string meaning) {
  ParameterSpec spec = number_parameter(std::move(name), std::move(unit), std::move(default_value),
                                        0.0, max, std::move(meaning));
  spec.min_is_allowed = false;
  return spec;
}

ParameterSpec integer_parameter(std::string name, std::string default_value, double min, double max,
                                std::string meaning) {
  ParameterSpec spec =
      number_parameter(std::move(name), "", std::move(default_value), min, max, std::move(meaning));
  spec.type = ParameterType::kInteger;
  return spec;
}

ParameterSpec flag_parameter(std::string name, std::string default_value, std::string meaning) {
  ParameterSpec spec;
  spec.name = std::move(name);
  spec.type = ParameterType::kFlag;
  spec.default_value = std::move(default_value);
  spec.meaning = std::move(meaning);
  return spec;
}

ParameterSpec choice_parameter(std::string name, std::string default_value,
                               std::vector<std::string> choices, std::string meaning) {
  ParameterSpec spec =
      flag_parameter(std::move(name), std::move(default_value), std::move(meaning));
  spec.type = ParameterType::kText;
  spec.choices = std::move(choices);
  return spec;
}

ParameterSpec vector_parameter(std::string name, std::string unit, std::string default_value,
                               double max_norm, std::string meaning) {
  ParameterSpec spec = number_parameter(std::move(name), std::move(unit), std::move(default_value),
                                        0.0, max_norm, std::move(meaning));
  spec.type = ParameterType::kVector;
  return spec;
}

ParameterSpec renamed(ParameterSpec spec, std::string former_name) {
  spec.former_name = std::move(former_name);
  return spec;
}

const ParameterSpec* find_renamed(const std::vector<ParameterSpec>& specs,
                                  const std::string& name) {
  const auto found = std::find_if(specs.begin(), specs.end(), [&](const ParameterSpec& spec) {
    return !spec.former_name.empty() && spec.former_name == name;
  });
  return found == specs.end() ? nullptr : &*found;
}

const Parameters::Value& Parameters::at(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) throw std::logic_error("no parameter '" + name + "' was declared");
  return found->second;
}

double Parameters::number(const std::string& name) const { return std::get<double>(at(name)); }
int Parameters::integer(const std::string& name) const { return static_cast<int>(number(name)); }
bool Parameters::flag(const std::string& name) const { return std::get<bool>(at(name)); }
const std::string& Parameters::text(const std::string& name) const {
  return std::get<std::string>(at(name));
}
const Eigen::Vector3d& Parameters::vector(const std::string& name) const {
  return std::get<Eigen::Vector3d>(at(name));
}

double parse_number(const std::string& text, const std::string& where) {
  const std::string word = trimmed(text);
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  const bool complete = !word.empty() && *end == '\0';
  if (!complete || !std::isfinite(value)) {
    throw InputError(fmt::format("{} is '{}', but must be a finite number", where, word));
  }
  return value;
}

std::vector<double> parse_numbers(const std::string& text, const std::string& where) {
  std::string words = trimmed(text);
  if (words.size() >= 2 && words.front() == '[' && words.back() == ']') {
    words = words.substr(1, words.size() - 2);
  }
  std::replace(words.begin(), words.end(), ',', ' ');
  std::istringstream stream(words);
  std::vector<double> values;
  for (std::string word; stream >> word;) values.push_back(parse_number(word, where));
  return values;
}

Parameters parse_parameters(const std::vector<ParameterSpec>& specs, const ParameterText& text,
                            const std::string& where) {
  for (const auto& [name, value] : text) check_name(specs, name, where);
  Parameters parameters;
  for (const ParameterSpec& spec : specs) {
    const auto given = text.find(spec.name);
    if (given == text.end() && spec.default_value.empty()) {
      throw InputError(
          fmt::format("{}: '{}' is missing; give {}", where, spec.name, spec.range_text()));
    }
    const std::string& raw = given == text.end() ? spec.default_value : given->second;
    parameters.set(spec.name, parse_value(spec, raw, where));
  }
  return parameters;
}

}  // namespace pliant
