#include "pliant/scene/yaml/yaml_tree.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <sstream>

#include "pliant/math/error.h"
#include "pliant/scene/yaml/text_file.h"

namespace pliant {
namespace {

/// Builds nodes from the parser's events. The library's own tree would join duplicate keys, follow
/// aliases without end and forget which file a line belongs to.
class TreeBuilder final : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::string& file) : file_(std::make_shared<std::string>(file)) {}

  YamlNode take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    check(mark, anchor, "");
    if (expects_key()) refuse(mark, "a key is missing");
    YamlNode node = make(mark, YamlNode::Kind::kNull);
    // The parser's mark is that of what comes next, maybe many lines below.
    if (!open_.empty() && open_.back().has_key) {
      node.line = open_.back().node.entries.back().key_place.line;
    }
    add(std::move(node));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse(mark, "aliases (*name) are not allowed; use `include`");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    check(mark, anchor, tag);
    const auto is_control = [](char c) {
      return static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t';
    };
    if (std::any_of(value.begin(), value.end(), is_control)) {
      refuse(mark, "a text holds a control character");
    }
    if (expects_key()) {
      set_key(mark, value);
      return;
    }
    YamlNode node = make(mark, YamlNode::Kind::kScalar);
    node.text = value;
    add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::kList);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::kMap);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    YamlNode node;
    bool has_key = false;  // of a map: the next event is the last entry's value
  };

  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", *file_, mark.line + 1, what));
  }

  void check(const YAML::Mark& mark, YAML::anchor_t anchor, const std::string& tag) const {
    if (anchor != 0) refuse(mark, "anchors (&name) are not allowed; use `include`");
    // "?" and "!" are what the parser calls plain and quoted text without a tag.
    if (!tag.empty() && tag != "?" && tag != "!") refuse(mark, "tags (!name) are not allowed");
  }

  YamlNode make(const YAML::Mark& mark, YamlNode::Kind kind) const {
    YamlNode node;
    node.kind = kind;
    node.file = file_;
    node.line = mark.line + 1;
    return node;
  }

  bool expects_key() const {
    return !open_.empty() && open_.back().node.kind == YamlNode::Kind::kMap &&
           !open_.back().has_key;
  }

  void set_key(const YAML::Mark& mark, const std::string& key) {
    YamlNode& map = open_.back().node;
    for (const YamlEntry& entry : map.entries) {
      if (entry.key == key) {
        refuse(mark,
               fmt::format("key '{}' is there already, in line {}", key, entry.key_place.line));
      }
    }
    if (map.entries.size() == kMaxYamlKeys) {
      refuse(mark, fmt::format("a map has more than {} keys", kMaxYamlKeys));
    }
    map.entries.push_back({key, {*file_, mark.line + 1}, make(mark, YamlNode::Kind::kNull)});
    open_.back().has_key = true;
  }

  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
            YamlNode::Kind kind) {
    check(mark, anchor, tag);
    if (expects_key()) refuse(mark, "a key must be a word");
    if (open_.size() == kMaxYamlDepth) {
      refuse(mark, fmt::format("nested deeper than {} maps and lists", kMaxYamlDepth));
    }
    open_.push_back({make(mark, kind), false});
  }

  void close() {
    YamlNode node = std::move(open_.back().node);
    open_.pop_back();
    add(std::move(node));
  }

  void add(YamlNode node) {
    if (open_.empty()) {
      root_ = std::move(node);
    } else if (open_.back().node.kind == YamlNode::Kind::kList) {
      open_.back().node.items.push_back(std::move(node));
    } else {
      open_.back().node.entries.back().value = std::move(node);
      open_.back().has_key = false;
    }
  }

  std::shared_ptr<const std::string> file_;
  std::vector<Open> open_;
  YamlNode root_;
};

YamlNode parse_document(const std::string& text, const std::string& file) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  TreeBuilder builder(file);
  if (!parser.HandleNextDocument(builder)) throw InputError(file + ":1: the file is empty");
  TreeBuilder second(file);
  if (parser.HandleNextDocument(second)) {
    throw InputError(fmt::format("{}:{}: a second document begins; one file holds one", file,
                                 second.take().line));
  }
  return builder.take();
}

}  // namespace

const YamlNode* YamlNode::find(const std::string& key) const {
  for (const YamlEntry& entry : entries) {
    if (entry.key == key) return &entry.value;
  }
  return nullptr;
}

std::string YamlNode::described() const {
  constexpr std::size_t kShown = 60;
  switch (kind) {
    case Kind::kNull:
      return "empty";
    case Kind::kList:
      return items.empty() ? "an empty list" : "a list";
    case Kind::kMap:
      return "a map";
    case Kind::kScalar:
      break;
  }
  return text.size() <= kShown ? "'" + text + "'" : "'" + text.substr(0, kShown) + "...'";
}

YamlNode parse_yaml(const std::string& text, const std::string& file) {
  check_text(text, file);
  YamlNode root;
  try {
    root = parse_document(text, file);
  } catch (const YAML::Exception& error) {
    const int line = error.mark.is_null() ? 1 : error.mark.line + 1;
    throw InputError(fmt::format("{}:{}: not valid YAML: {}", file, line, error.msg));
  }
  if (root.kind == YamlNode::Kind::kNull) throw InputError(file + ":1: the file is empty");
  if (root.kind != YamlNode::Kind::kMap) {
    throw InputError(fmt::format("{}:{}: the file is {}, but must be a map of keys", file,
                                 root.line, root.described()));
  }
  return root;
}

YamlNode read_yaml_file(const std::string& path) {
  return parse_yaml(read_text_file(path, kMaxYamlBytes), path);
}

}  // namespace pliant
