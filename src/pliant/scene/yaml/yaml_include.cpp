#include "pliant/scene/yaml/yaml_include.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "pliant/math/error.h"
#include "pliant/scene/yaml/yaml_map.h"

namespace pliant {
namespace {

void merge(const YamlNode& over, YamlNode& base) {
  if (over.kind != YamlNode::Kind::kMap || base.kind != YamlNode::Kind::kMap) {
    base = over;
    return;
  }
  base.file = over.file;
  base.line = over.line;
  for (const YamlEntry& entry : over.entries) {
    const auto same = [&](const YamlEntry& other) { return other.key == entry.key; };
    const auto found = std::find_if(base.entries.begin(), base.entries.end(), same);
    if (found == base.entries.end()) {
      base.entries.push_back(entry);
    } else {
      found->key_place = entry.key_place;
      merge(entry.value, found->value);
    }
  }
}

class Includer {
 public:
  explicit Includer(const PackageResolver& resolver) : resolver_(resolver) {}

  /// `text`: of the file; null: it is read.
  YamlNode read(const std::string& path, const std::string& where,
                const std::string* text = nullptr) {
    std::error_code ignored;
    const std::string real = std::filesystem::weakly_canonical(path, ignored).string();
    if (std::find(open_.begin(), open_.end(), real) != open_.end()) {
      throw InputError(where + ": '" + path + "' includes itself");
    }
    if (++files_ > kMaxIncludedFiles) {
      throw InputError(
          fmt::format("{}: more than {} files are included", where, kMaxIncludedFiles));
    }
    if (!where.empty() && !std::filesystem::exists(path, ignored)) {
      throw InputError(where + ": there is no file '" + path + "'");
    }
    open_.push_back(real);
    YamlNode own = text == nullptr ? read_yaml_file(path) : parse_yaml(*text, path);
    YamlNode merged = with_included(own);
    open_.pop_back();
    return merged;
  }

 private:
  YamlNode with_included(YamlNode& own) {
    const auto is_include = [](const YamlEntry& entry) { return entry.key == "include"; };
    const auto found = std::find_if(own.entries.begin(), own.entries.end(), is_include);
    if (found == own.entries.end()) return std::move(own);
    const YamlNode include = std::move(found->value);
    own.entries.erase(found);
    YamlNode merged;
    merged.kind = YamlNode::Kind::kMap;
    for (const YamlNode& item : paths(include)) {
      const std::string where = item.place().text() + ": include";
      const std::string text = read_text(item, "include");
      merge(read(resolve_path(text, *item.file, resolver_, where), where), merged);
    }
    merge(own, merged);
    return merged;
  }

  static std::vector<YamlNode> paths(const YamlNode& include) {
    if (include.kind == YamlNode::Kind::kScalar) return {include};
    return read_list(include, "include", "a list of paths");
  }

  const PackageResolver& resolver_;
  std::vector<std::string> open_;  // files being read, the outermost first
  int files_ = 0;
};

}  // namespace

YamlNode read_yaml_with_includes(const std::string& path, const PackageResolver& resolver,
                                 const std::string* text) {
  return Includer(resolver).read(path, "", text);
}

}  // namespace pliant
