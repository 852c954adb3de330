#include "pliant/scene/robot/link_choice.h"

#include <fnmatch.h>

#include "pliant/math/error.h"

namespace pliant {
namespace {

bool matches(const LinkChoice::Pattern& pattern, const std::string& link,
             const std::string& prefix) {
  const auto fits = [&](const std::string& text) {
    return fnmatch(text.c_str(), link.c_str(), 0) == 0;
  };
  return fits(pattern.text) || (!prefix.empty() && fits(prefix + pattern.text));
}

/// Sets `chosen` of the links that match one of the patterns.
void mark(const std::vector<LinkChoice::Pattern>& patterns, const std::vector<std::string>& links,
          const std::string& prefix, bool value, std::vector<bool>& chosen) {
  for (const LinkChoice::Pattern& pattern : patterns) {
    bool found = false;
    for (std::size_t i = 0; i < links.size(); ++i) {
      if (!matches(pattern, links[i], prefix)) continue;
      found = true;
      chosen[i] = value;
    }
    if (found) continue;
    throw InputError(pattern.place.text() + ": robot.links: " +
                     unknown_name_message("link or pattern", pattern.text, links));
  }
}

}  // namespace

std::vector<bool> LinkChoice::choose(const std::vector<std::string>& links,
                                     const std::string& prefix) const {
  std::vector<bool> chosen(links.size(), include.empty());
  mark(include, links, prefix, true, chosen);
  mark(exclude, links, prefix, false, chosen);
  return chosen;
}

}  // namespace pliant
