#include "pliant/scene/yaml/scene_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "pliant/math/error.h"
#include "pliant/scene/yaml/place_error.h"
#include "pliant/scene/yaml/text_file.h"

namespace pliant {
namespace {

constexpr std::size_t kMaxLineBytes = 1'000'000;

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

/// The cells of a line.
std::vector<std::string> cells_of(const std::string& line, const SourcePlace& place) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (std::size_t at = 0; at < line.size(); ++at) {
    const char c = line[at];
    if (c == '"' && is_quoted && at + 1 < line.size() && line[at + 1] == '"') {
      cells.back() += line[++at];
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (c == ',' && !is_quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  if (is_quoted) throw InputError(place.text() + ": a quote is not closed");
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

SceneTable::SceneTable(const std::string& path) : path_(path), file_(open_text_file(path)) {
  std::string line;
  while (next_line(line)) {
    const std::vector<std::string> cells = cells_of(line, {path_, line_});
    if (line_ == 1) {
      take_paths(cells);
    } else if (!line.empty() && line != "\r") {
      check_cells(cells);
      ++size_;
    }
  }
  if (size_ == 0) {
    throw InputError(path +
                     ": no rows; the first line names what varies, each further one is a scene");
  }
  rewind();
}

bool SceneTable::next_line(std::string& line) {
  if (!std::getline(file_, line)) return false;
  ++line_;
  if (line.size() > kMaxLineBytes) {
    throw InputError(fmt::format("{}:{}: the line has {} bytes, but at most {} are allowed", path_,
                                 line_, line.size(), kMaxLineBytes));
  }
  check_text(line, path_, line_);
  return true;
}

void SceneTable::take_paths(const std::vector<std::string>& cells) {
  paths_ = cells;
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    const auto begin = paths_.begin(), here = begin + static_cast<std::ptrdiff_t>(k);
    if (std::find(begin, here, *here) != here) {
      throw InputError(fmt::format("{}:1: column '{}' is given twice", path_, *here));
    }
  }
}

void SceneTable::check_cells(const std::vector<std::string>& cells) const {
  if (cells.size() == paths_.size()) return;
  throw InputError(fmt::format(
      "{}:{}: {} cells, but the first line has {} columns; a cell with commas stands in quotes",
      path_, line_, cells.size(), paths_.size()));
}

void SceneTable::rewind() {
  if (path_.empty()) return;
  file_.clear();
  file_.seekg(0);
  line_ = 0;
  std::string line;
  next_line(line);
}

std::vector<SceneValue> SceneTable::next() {
  if (path_.empty()) return {};
  std::string line;
  while (next_line(line)) {
    if (line.empty() || line == "\r") continue;
    const SourcePlace place = {path_, line_};
    const std::vector<std::string> cells = cells_of(line, place);
    check_cells(cells);
    std::vector<SceneValue> row;
    for (std::size_t k = 0; k < cells.size(); ++k) row.push_back({paths_[k], cells[k], place});
    return row;
  }
  throw InputError(path_ + ": it has fewer rows than before; has somebody changed it?");
}

}  // namespace pliant
