#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pliant/scene/yaml/source_place.h"

namespace pliant {

struct YamlEntry;

/// A value of a YAML file that knows where it was written.
struct YamlNode {
  enum class Kind { kNull, kScalar, kList, kMap };

  Kind kind = Kind::kNull;
  std::string text;                ///< kScalar
  std::vector<YamlNode> items;     ///< kList
  std::vector<YamlEntry> entries;  ///< kMap, in the file's order; keys are unique
  std::shared_ptr<const std::string> file;
  int line = 1;

  SourcePlace place() const { return {*file, line}; }
  /// The value of `key`, or null when this is no map or has none.
  const YamlNode* find(const std::string& key) const;
  /// "'text'", "a list", "a map" or "empty", for messages.
  std::string described() const;
};

struct YamlEntry {
  std::string key;
  SourcePlace key_place;
  YamlNode value;
};

constexpr std::size_t kMaxYamlBytes = 2'000'000;
constexpr std::size_t kMaxYamlKeys = 1000;  ///< of one map
constexpr std::size_t kMaxYamlDepth = 32;

/// Reads a file that holds one YAML map. Throws InputError "FILE:LINE: ...": a file that is
/// missing, no regular file, empty, binary, not UTF-8 or longer than kMaxYamlBytes; a syntax error;
/// a key given twice; anchors, aliases and tags; maps or lists nested deeper than kMaxYamlDepth.
YamlNode read_yaml_file(const std::string& path);

/// The same for text that is known as `file` in messages.
YamlNode parse_yaml(const std::string& text, const std::string& file);

}  // namespace pliant
