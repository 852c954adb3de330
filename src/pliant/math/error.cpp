#include "pliant/math/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <utility>

namespace pliant {
namespace {

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Optimal string alignment distance: insert, delete, replace, swap of neighbours, each costs 1.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before_last, last);
    std::swap(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replace});
      const bool swapped =
          i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && a[i - 1] != b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

// Beyond this length a name is not a slip of the pen, and comparing it would only cost time.
constexpr std::size_t kLongestName = 100;

}  // namespace

InputError::InputError(const std::string& message) : std::runtime_error(message) {}

std::string nearest_name(const std::string& name, const std::vector<std::string>& allowed) {
  if (name.empty() || name.size() > kLongestName) return {};
  // More edits than a third of the letters and the names merely share a few.
  std::size_t least = std::max<std::size_t>(1, name.size() / 3) + 1;
  std::string nearest;
  for (const std::string& candidate : allowed) {
    if (candidate.empty() || candidate.size() > name.size() + least) continue;
    const std::size_t distance = edit_distance(lower_case(name), lower_case(candidate));
    // As many edits as the candidate has letters would make any name near a short one.
    if (distance < least && distance < candidate.size()) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string unknown_name_message(const std::string& kind, const std::string& name,
                                 const std::vector<std::string>& allowed) {
  if (allowed.empty()) return fmt::format("unknown {} '{}': none is allowed", kind, name);
  const std::string nearest = nearest_name(name, allowed);
  const std::string hint = nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest);
  const char* verb = allowed.size() == 1 ? "is" : "are";
  return fmt::format("unknown {} '{}': allowed {} {}{}", kind, name, verb, fmt::join(allowed, ", "),
                     hint);
}

}  // namespace pliant
