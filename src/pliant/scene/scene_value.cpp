#include "pliant/scene/scene_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "pliant/math/error.h"
#include "pliant/scene/place_error.h"
#include "pliant/scene/text_file.h"

namespace pliant {
namespace {

constexpr std::size_t kMaxTableBytes = 100'000'000;

/// Walks a path from the tree's root.
class PathWalk {
 public:
  PathWalk(const SceneValue& value, YamlNode& root) : value_(value), node_(&root) {}

  YamlNode& end() {
    while (at_ < value_.path.size()) {
      if (value_.path[at_] == '[') {
        item();
      } else {
        if (at_ > 0) expect('.');
        key();
      }
    }
    if (value_.path.empty()) refuse("is empty; write for example bodies[0].material.density");
    return *node_;
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(fmt::format("{}: path '{}' {}", value_.place.text(), value_.path, why));
  }
  std::string walked() const {
    return at_ == 0 ? "the scene" : "'" + value_.path.substr(0, at_) + "'";
  }
  void expect(char c) {
    if (value_.path[at_] != c) {
      refuse(fmt::format("has '{}' after {}, where '.' or '[' is expected", value_.path[at_],
                         walked()));
    }
    ++at_;
  }

  void key() {
    const std::size_t end = std::min(value_.path.find_first_of(".[", at_), value_.path.size());
    const std::string name = value_.path.substr(at_, end - at_);
    if (name.empty()) refuse("has an empty key");
    if (node_->kind == YamlNode::Kind::kNull) node_->kind = YamlNode::Kind::kMap;
    if (node_->kind != YamlNode::Kind::kMap) {
      refuse(fmt::format("leads nowhere: {} is {}, no map", walked(), node_->described()));
    }
    const auto same = [&](const YamlEntry& entry) { return entry.key == name; };
    auto found = std::find_if(node_->entries.begin(), node_->entries.end(), same);
    if (found == node_->entries.end()) {
      YamlEntry entry;
      entry.key = name;
      entry.key_place = value_.place;
      entry.value.file = std::make_shared<std::string>(value_.place.file);
      entry.value.line = value_.place.line;
      found = node_->entries.insert(found, std::move(entry));
    }
    node_ = &found->value;
    at_ = end;
  }

  void item() {
    const std::size_t close = value_.path.find(']', at_);
    if (close == std::string::npos) refuse("lacks a ']'");
    const std::string name = value_.path.substr(at_ + 1, close - at_ - 1);
    if (node_->kind != YamlNode::Kind::kList) {
      refuse(fmt::format("leads nowhere: {} is {}, no list", walked(), node_->described()));
    }
    std::size_t index = 0;
    const auto [last, error] = std::from_chars(name.data(), name.data() + name.size(), index);
    if (error != std::errc() || last != name.data() + name.size()) index = named(name);
    if (index >= node_->items.size()) {
      refuse(
          fmt::format("leads nowhere: {} has {} items, from 0 on", walked(), node_->items.size()));
    }
    node_ = &node_->items[index];
    at_ = close + 1;
  }

  std::size_t named(const std::string& name) const {
    std::vector<std::string> names;
    for (const YamlNode& item : node_->items) {
      const YamlNode* own = item.find("name");
      names.push_back(own == nullptr ? "" : own->text);
      if (own != nullptr && own->text == name) return names.size() - 1;
    }
    refuse("leads nowhere: " + unknown_name_message("item of " + walked(), name, names));
  }

  const SceneValue& value_;
  YamlNode* node_;
  std::size_t at_ = 0;
};

void set_place(YamlNode& node, int line) {
  node.line = line;
  for (YamlNode& item : node.items) set_place(item, line);
  for (YamlEntry& entry : node.entries) {
    entry.key_place.line = line;
    set_place(entry.value, line);
  }
}

/// One line's cells, of a file read up to `at`, which goes on to the next line.
std::vector<std::string> read_row(const std::string& text, std::size_t& at,
                                  const SourcePlace& place) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '"' && is_quoted && at + 1 < text.size() && text[at + 1] == '"') {
      cells.back() += text[++at];
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (c == '\n') {
      break;
    } else if (c == ',' && !is_quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  if (is_quoted) throw InputError(place.text() + ": a quote is not closed");
  ++at;
  return cells;
}

}  // namespace

void set_value(const SceneValue& value, YamlNode& root) {
  YamlNode& node = PathWalk(value, root).end();
  const std::string where = value.place.text() + ": " + value.path;
  YamlNode tree =
      with_place(where, [&] { return parse_yaml("value: " + value.text, value.place.file); });
  if (tree.entries.size() != 1 || tree.entries.front().key != "value") {
    throw InputError(where + " is '" + value.text + "', but must be one value");
  }
  set_place(tree, value.place.line);
  node = std::move(tree.entries.front().value);
}

SceneValueTable read_scene_values(const std::string& path) {
  const std::string text = read_text_file(path, kMaxTableBytes);
  check_text(text, path);
  SceneValueTable table;
  std::size_t at = 0;
  table.paths = read_row(text, at, {path, 1});
  for (std::size_t k = 0; k < table.paths.size(); ++k) {
    const auto begin = table.paths.begin(), here = begin + static_cast<std::ptrdiff_t>(k);
    if (std::find(begin, here, *here) != here) {
      throw InputError(fmt::format("{}:1: column '{}' is given twice", path, *here));
    }
  }
  for (int line = 2; at < text.size(); ++line) {
    const SourcePlace place = {path, line};
    const std::vector<std::string> cells = read_row(text, at, place);
    if (cells.size() == 1 && cells.front().empty()) continue;
    if (cells.size() != table.paths.size()) {
      throw InputError(fmt::format(
          "{}: {} cells, but the first line has {} columns; a cell with commas stands in quotes",
          place.text(), cells.size(), table.paths.size()));
    }
    table.rows.emplace_back();
    for (std::size_t k = 0; k < cells.size(); ++k) {
      table.rows.back().push_back({table.paths[k], cells[k], place});
    }
  }
  if (table.rows.empty()) {
    throw InputError(path +
                     ": no rows; the first line names what varies, each further one is a scene");
  }
  return table;
}

}  // namespace pliant
