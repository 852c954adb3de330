#pragma once

#include <string>

#include "pliant/scene/robot/packages.h"
#include "pliant/scene/yaml/yaml_tree.h"

namespace pliant {

constexpr int kMaxIncludedFiles = 64;

/// Reads a YAML file and those that its key `include` (a path or a list of paths, relative to the
/// file) names. Included files come first, in order, and later keys win: maps are merged key by
/// key, everything else is replaced. The result has no key `include`. Throws InputError "FILE:LINE:
/// ..." as read_yaml_file() does, for a file that includes itself, and for more than
/// kMaxIncludedFiles. `text`, unless it is null, stands for what is in the file `path`.
YamlNode read_yaml_with_includes(const std::string& path, const PackageResolver& resolver,
                                 const std::string* text = nullptr);

}  // namespace pliant
