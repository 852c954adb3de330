#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pliant/geometry/mesh_checks/mesh_checks.h"
#include "pliant/geometry/mesh_checks/node_graph.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr std::size_t kMostLevels = 500;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// The tags of a COLLADA file, which is XML.
class Check {
 public:
  Check(const std::string& path, std::string_view text) : path_(path), text_(text) {}

  void run() {
    if (text_.find('\0') != std::string_view::npos) fail("has null characters: write it as UTF-8");
    for (std::size_t i = text_.find('<'); i < text_.size(); i = text_.find('<', i)) i = tag(i);
    for (const auto& [holder, id] : instances_) {
      const auto [first, last] =
          by_id_.count(id) > 0 ? by_id_.equal_range(id) : by_name_.equal_range(id);
      for (auto found = first; found != last; ++found) graph_.add_child(holder, found->second);
    }
    graph_.check(path_);
  }

 private:
  using Attributes = std::map<std::string_view, std::string_view>;

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("mesh '{}': {}", path_, what));
  }

  std::size_t after(std::string_view end, std::size_t begin) const {
    const std::size_t found = text_.find(end, begin);
    return found == std::string_view::npos ? text_.size() : found + end.size();
  }

  /// What begins at `i`; returns where it ends.
  std::size_t tag(std::size_t i) {
    const std::string_view rest = text_.substr(i);
    if (rest.rfind("<!--", 0) == 0) return after("-->", i + 4);
    if (rest.rfind("<![CDATA[", 0) == 0) return after("]]>", i);
    if (rest.rfind("<?", 0) == 0) return after("?>", i);
    if (rest.rfind("<!", 0) == 0) fail("has a document type or entities, which are not read");
    if (rest.rfind("</", 0) == 0) {
      if (!open_.empty()) open_.pop_back();
      return after(">", i);
    }
    return begin_tag(i + 1);
  }

  std::size_t begin_tag(std::size_t i) {
    const auto is_end = [&] { return i >= text_.size() || text_[i] == '>' || text_[i] == '/'; };
    const auto word = [&] {
      const std::size_t begin = i;
      while (!is_end() && !is_space(text_[i]) && text_[i] != '=') ++i;
      return text_.substr(begin, i - begin);
    };
    const auto skip = [&] {
      while (i < text_.size() && is_space(text_[i])) ++i;
    };
    const std::string_view name = word();
    Attributes attributes;
    for (skip(); !is_end(); skip()) {
      const std::string_view key = word();
      skip();
      if (i >= text_.size() || text_[i] != '=') fail("an attribute has no value");
      ++i;
      skip();
      const char quote = i < text_.size() ? text_[i] : '\0';
      const std::size_t end = text_.find(quote, i + 1);
      if ((quote != '"' && quote != '\'') || end == std::string_view::npos) {
        fail("an attribute's value is not in quotes");
      }
      attributes.emplace(key, text_.substr(i + 1, end - i - 1));
      i = end + 1;
    }
    const bool is_empty = i < text_.size() && text_[i] == '/';
    begin_element(name, attributes, is_empty);
    return after(">", i);
  }

  void begin_element(std::string_view name, const Attributes& attributes, bool is_empty) {
    check_counts(attributes);
    int node = holder();
    // The importer keeps scenes among the nodes: an instance can name one.
    if (name == "node" || name == "visual_scene") {
      node = graph_.add(value(attributes, "id"));
      by_id_.emplace(value(attributes, "id"), node);
      by_name_.emplace(value(attributes, "name"), node);
      if (holder() >= 0) graph_.add_child(holder(), node);
    }
    if (name == "instance_node" && holder() >= 0) {
      const std::string url = value(attributes, "url");
      if (!url.empty()) instances_.emplace_back(holder(), url.substr(1));
    }
    if (is_empty) return;
    open_.push_back(node);
    if (open_.size() > kMostLevels) {
      fail(fmt::format("elements are nested deeper than {}", kMostLevels));
    }
  }

  /// The node that holds what comes next; -1: none.
  int holder() const { return open_.empty() ? -1 : open_.back(); }

  std::string value(const Attributes& attributes, const char* key) const {
    const auto found = attributes.find(key);
    if (found == attributes.end()) return {};
    if (found->second.find('&') != std::string_view::npos) {
      fail(fmt::format("the {} '{}' of a node has an escape, which is not read", key,
                       found->second));
    }
    return std::string(found->second);
  }

  /// Each of what they count takes a byte at least.
  void check_counts(const Attributes& attributes) const {
    for (const char* key : {"count", "stride", "offset"}) {
      const auto found = attributes.find(key);
      if (found == attributes.end()) continue;
      double number = 0.0;
      const std::string_view text = found->second;
      const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
      if (read.ec == std::errc::result_out_of_range) number = HUGE_VAL;
      if (number >= 0.0 && number <= static_cast<double>(text_.size())) continue;
      fail(fmt::format("{} is {}, but the file has {} bytes", key, text, text_.size()));
    }
  }

  const std::string& path_;
  std::string_view text_;
  NodeGraph graph_;
  std::vector<int> open_;  // of each open element: the node that it is or is in
  std::multimap<std::string, int> by_id_, by_name_;
  std::vector<std::pair<int, std::string>> instances_;
};

}  // namespace

void check_collada(const std::string& path, std::string_view bytes) { Check(path, bytes).run(); }

}  // namespace pliant
