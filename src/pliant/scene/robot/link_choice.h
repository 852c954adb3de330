#pragma once

#include <string>
#include <vector>

#include "pliant/scene/yaml/source_place.h"

namespace pliant {

/// Which links of a robot touch things. Names, or patterns with *, ? and [...] as a shell knows
/// them.
struct LinkChoice {
  struct Pattern {
    std::string text;
    SourcePlace place;
  };
  std::vector<Pattern> include;  ///< empty: all
  std::vector<Pattern> exclude;  ///< of those

  /// One entry a link. Patterns may leave out the `prefix` of the names. Throws InputError
  /// "FILE:LINE: ..." for a pattern that no link matches, with the nearest name.
  std::vector<bool> choose(const std::vector<std::string>& links, const std::string& prefix) const;
};

}  // namespace pliant
