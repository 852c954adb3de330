#include "pliant/ros/body_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

#include "pliant/math/error.h"

namespace pliant {
namespace {

// Of the locale's letters ROS allows none.
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool is_allowed(char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; }

/// Whether `name` is one of those that the scene joined to one body, which is called "a+b".
bool is_part_of(const std::string& name, const std::string& joined) {
  return joined.find('+') != std::string::npos &&
         ("+" + joined + "+").find("+" + name + "+") != std::string::npos;
}

}  // namespace

std::string graph_name_of(const std::string& name, const std::string& prefix) {
  std::string graph_name;
  for (const char c : name) {
    // One for all bytes of a letter such as ü.
    const bool goes_on = !is_allowed(c) && !graph_name.empty() && graph_name.back() == '_';
    if (!goes_on) graph_name += is_allowed(c) ? c : '_';
  }
  return !graph_name.empty() && is_letter(graph_name.front()) ? graph_name : prefix + graph_name;
}

std::vector<std::string> graph_names_of(const std::vector<std::string>& names,
                                        const std::string& prefix) {
  std::vector<std::string> result;
  // Names that need no change are kept, whatever becomes of others.
  for (const std::string& name : names) {
    const bool is_free = std::count(result.begin(), result.end(), name) == 0;
    result.push_back(is_free && graph_name_of(name, prefix) == name ? name : "");
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!result[k].empty()) continue;
    const std::string wanted = graph_name_of(names[k], prefix);
    std::string free = wanted;
    for (int n = 2; std::count(result.begin(), result.end(), free) > 0; ++n) {
      free = fmt::format("{}_{}", wanted, n);
    }
    result[k] = free;
  }
  return result;
}

BodyNames::BodyNames(const std::deque<Body>& bodies) {
  std::vector<std::string> names;
  for (const Body& body : bodies) names.push_back(body.name);
  const std::vector<std::string> graph_names = graph_names_of(names, "body_");
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    entries_.push_back({names[b], graph_names[b], std::string(bodies[b].model->name())});
  }
}

std::vector<std::size_t> BodyNames::find(const std::string& where, const std::string& name) const {
  std::vector<std::size_t> found;
  for (std::size_t b = 0; b < entries_.size(); ++b) {
    if (name.empty() || entries_[b].name == name) found.push_back(b);
  }
  for (std::size_t b = 0; found.empty() && b < entries_.size(); ++b) {
    if (entries_[b].graph_name == name) found.push_back(b);
  }
  if (found.empty()) refuse(where, name);
  return found;
}

void BodyNames::refuse(const std::string& where, const std::string& name) const {
  std::vector<std::string> names;
  for (const Entry& entry : entries_) {
    if (is_part_of(name, entry.name)) {
      throw InputError(
          fmt::format("{}: body '{}' is moved as one with others that it may touch: name '{}'",
                      where, name, entry.name));
    }
    names.push_back(entry.name);
  }
  throw InputError(where + ": " + unknown_name_message("body", name, names));
}

std::string BodyNames::text(const std::vector<std::size_t>& bodies) const {
  if (bodies.size() > 1 && bodies.size() == size()) return fmt::format("all {} bodies", size());
  std::vector<std::string> quoted;
  for (const std::size_t b : bodies) quoted.push_back("'" + name(b) + "'");
  return fmt::format("{}", fmt::join(quoted, ", "));
}

std::vector<std::string> BodyNames::replaced() const {
  std::vector<std::string> lines;
  for (const Entry& entry : entries_) {
    // One alone has no topics of its own.
    if (size() == 1 || entry.name == entry.graph_name) continue;
    lines.push_back(
        fmt::format("the topics of body '{}' are called '{}', since ROS does not allow its name",
                    entry.name, entry.graph_name));
  }
  return lines;
}

}  // namespace pliant
