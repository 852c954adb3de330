#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/parameters.h"
#include "pliant/scene/yaml/yaml_tree.h"

namespace pliant {

/// A map of a YAML file, checked. `field` is its path in the file ("bodies[0].geometry", "" for the
/// file itself). Every function here throws InputError "FILE:LINE: ..." that names the field, what
/// it must be, and the nearest allowed name.
class YamlMap {
 public:
  /// Refuses what is no map, a key that is neither in `specs` nor in `others`, a missing required
  /// one, and a value that its spec does not allow.
  YamlMap(const YamlNode& node, std::string field, const std::vector<ParameterSpec>& specs,
          const std::vector<std::string>& others = {});

  bool has(const std::string& key) const { return node_.find(key) != nullptr; }
  /// Those in `specs`, with defaults.
  double number(const std::string& key) const { return values_.number(key); }
  int integer(const std::string& key) const { return values_.integer(key); }
  bool flag(const std::string& key) const { return values_.flag(key); }
  const std::string& text(const std::string& key) const { return values_.text(key); }
  const Eigen::Vector3d& vector(const std::string& key) const { return values_.vector(key); }
  const Parameters& values() const { return values_; }
  std::optional<double> optional_number(const std::string& key) const;

  /// Null when the key is not there.
  const YamlNode* find(const std::string& key) const { return node_.find(key); }
  /// Refuses a missing key; `expected` says what to give.
  const YamlNode& require(const std::string& key, const std::string& expected) const;
  std::string field(const std::string& key) const { return child_field(field_, key); }
  SourcePlace place() const { return node_.place(); }
  const std::string& name() const { return field_; }  ///< its own field

  static std::string child_field(const std::string& field, const std::string& key);

 private:
  const YamlNode& node_;
  std::string field_;
  Parameters values_;
};

/// Throws "FILE:LINE: FIELD is VALUE, but must be EXPECTED".
[[noreturn]] void refuse_value(const YamlNode& node, const std::string& field,
                               const std::string& expected);

/// Throws "FILE:LINE: unknown key 'K' in FIELD; allowed are ..." at the first unknown key.
void check_keys(const YamlNode& node, const std::string& field,
                const std::vector<std::string>& allowed);

/// The value as a parameter parser wants it: "0.5" or "[0, 0, 1]".
std::string parameter_text(const YamlNode& node, const std::string& field);

/// The parameters of a registry's entry in the map (or nothing) `node`, except the keys `skip`.
/// Names, values and missing ones are checked against `specs`.
ParameterText read_parameters(const YamlNode& node, const std::string& field,
                              const std::vector<ParameterSpec>& specs,
                              const std::vector<std::string>& skip = {});

/// A text of at least one character.
std::string read_text(const YamlNode& node, const std::string& field);
/// 1 to 64 letters, digits, '_' or '-': names become parts of file and topic names.
std::string read_name(const YamlNode& node, const std::string& field);
/// The items of a list that is not empty.
const std::vector<YamlNode>& read_list(const YamlNode& node, const std::string& field,
                                       const std::string& expected);
/// `least` to `most` finite numbers within [min, max].
std::vector<double> read_numbers(const YamlNode& node, const std::string& field, int least,
                                 int most, double min, double max, const std::string& expected);

}  // namespace pliant
