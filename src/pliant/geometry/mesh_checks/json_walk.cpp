#include "pliant/geometry/mesh_checks/json_walk.h"

#include <fmt/format.h>

namespace pliant {
namespace {

using Visit = std::function<void(const std::vector<JsonLevel>&, std::string_view)>;

class Walk {
 public:
  Walk(std::string_view text, std::size_t most_levels, const Visit& visit)
      : text_(text.substr(0, text.find('\0'))), most_levels_(most_levels), visit_(visit) {}

  std::string run() {
    bool wants_value = true;
    while (error_.empty()) {
      skip_space();
      if (wants_value) {
        wants_value = value();
      } else if (levels_.empty()) {
        if (at_ < text_.size()) fail("more follows after its end");
        break;
      } else {
        wants_value = separator();
      }
    }
    return error_;
  }

 private:
  void fail(const std::string& why) {
    if (error_.empty()) error_ = fmt::format("not valid JSON at byte {}: {}", at_, why);
  }
  char here() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_space() {
    while (here() == ' ' || here() == '\t' || here() == '\n' || here() == '\r') ++at_;
  }
  bool is_in_array() const { return levels_.back().index >= 0; }

  std::string_view string() {
    const std::size_t begin = ++at_;
    while (here() != '"' && at_ < text_.size()) at_ += here() == '\\' ? 2 : 1;
    if (at_ >= text_.size()) {
      fail("a text without end");
      return {};
    }
    return text_.substr(begin, at_++ - begin);
  }

  void key() {
    skip_space();
    if (here() != '"') return fail("a key should be here");
    levels_.back().key = string();
    if (levels_.back().key.find('\\') != std::string_view::npos) {
      error_ = "a key has an escape: write it in plain characters";
    }
    skip_space();
    if (here() != ':') return fail("a colon should be here");
    ++at_;
  }

  /// Whether another value follows at once: the first of what begins here.
  bool value() {
    const char first = here();
    if (first == '{' || first == '[') return begin_container(first);
    const std::size_t begin = at_;
    if (first == '"') {
      const std::string_view text = string();
      if (error_.empty()) visit_(levels_, text);
      return false;
    }
    while (at_ < text_.size() && text_.find_first_of(",]} \t\r\n", at_) != at_) ++at_;
    if (at_ == begin) fail("a value should be here");
    if (error_.empty()) visit_(levels_, text_.substr(begin, at_ - begin));
    return false;
  }

  bool begin_container(char first) {
    visit_(levels_, text_.substr(at_, 1));
    ++at_;
    skip_space();
    if (here() == (first == '{' ? '}' : ']')) {
      ++at_;
      return false;
    }
    if (levels_.size() == most_levels_) {
      error_ = fmt::format("nested deeper than {}", most_levels_);
      return false;
    }
    levels_.emplace_back();
    if (first == '[') {
      levels_.back().index = 0;
    } else {
      key();
    }
    return true;
  }

  bool separator() {
    const char next = here();
    if (next == ',') {
      ++at_;
      if (is_in_array()) {
        ++levels_.back().index;
      } else {
        key();
      }
      return true;
    }
    if (next != (is_in_array() ? ']' : '}')) {
      fail("a comma or an end should be here");
      return false;
    }
    ++at_;
    levels_.pop_back();
    return false;
  }

  std::string_view text_;
  std::size_t most_levels_;
  const Visit& visit_;
  std::size_t at_ = 0;
  std::vector<JsonLevel> levels_;
  std::string error_;
};

}  // namespace

std::string walk_json(std::string_view text, std::size_t most_levels, const Visit& visit) {
  return Walk(text, most_levels, visit).run();
}

}  // namespace pliant
