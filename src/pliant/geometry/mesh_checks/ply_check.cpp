#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "pliant/geometry/mesh_checks/mesh_checks.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

struct Property {
  std::string count;  ///< the type of a list's length; empty: one value
  std::string type;
};

struct Element {
  std::string name;
  double count;
  std::vector<Property> properties;
};

/// Bytes of a type; 0 for an unknown one.
std::size_t size_of(const std::string& type) {
  static const std::vector<std::pair<std::size_t, std::vector<std::string>>> sizes = {
      {1, {"char", "uchar", "int8", "uint8"}},
      {2, {"short", "ushort", "int16", "uint16"}},
      {4, {"int", "uint", "int32", "uint32", "float", "float32"}},
      {8, {"double", "float64"}}};
  for (const auto& [size, names] : sizes) {
    for (const std::string& name : names) {
      if (name == type) return size;
    }
  }
  return 0;
}

class Check {
 public:
  Check(const std::string& path, std::string_view bytes) : path_(path), bytes_(bytes) {}

  void run() {
    if (!read_header()) return;
    for (const Element& element : elements_) {
      for (double k = 0.0; k < element.count; k += 1.0) {
        is_binary_ ? skip_binary(element) : skip_line(element);
      }
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("mesh '{}': {}", path_, what));
  }

  std::string_view line() {
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    std::string_view text = bytes_.substr(at_, end - at_);
    at_ = std::min(end + 1, bytes_.size());
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
  }

  /// Whether there is one.
  bool read_header() {
    if (line().rfind("ply", 0) != 0) return false;
    for (bool ends = false; !ends;) {
      if (at_ >= bytes_.size()) return false;
      std::istringstream words{std::string(line())};
      std::string keyword, word;
      words >> keyword >> word;
      if (keyword == "format") {
        is_binary_ = word != "ascii";
        is_swapped_ = word == "binary_big_endian";
      } else if (keyword == "element") {
        double count = -1.0;
        if (!(words >> count) || !(count >= 0.0) || count > static_cast<double>(bytes_.size())) {
          fail(fmt::format("announces more elements '{}' than the file can hold", word));
        }
        elements_.push_back({word, count, {}});
      } else if (keyword == "property" && !elements_.empty()) {
        Property property{"", word};
        if (word == "list") words >> property.count >> property.type;
        const bool known =
            size_of(property.type) > 0 && (property.count.empty() || size_of(property.count) > 0);
        if (!known)
          fail(
              fmt::format("element '{}' has a property of an unknown type", elements_.back().name));
        elements_.back().properties.push_back(std::move(property));
      }
      ends = keyword == "end_header";
    }
    return true;
  }

  void skip_bytes(double count) {
    if (!(count <= static_cast<double>(bytes_.size() - at_))) fail("the file ends too early");
    at_ += static_cast<std::size_t>(count);
  }

  /// Of a list, the number at the present place, which is passed.
  double length(const std::string& type) {
    char number[8] = {};
    const std::size_t size = size_of(type), begin = at_;
    skip_bytes(static_cast<double>(size));
    for (std::size_t k = 0; k < size; ++k) {
      number[k] = bytes_[begin + (is_swapped_ ? size - 1 - k : k)];
    }
    const auto as = [&](auto value) {
      std::memcpy(&value, number, sizeof(value));
      return static_cast<double>(value);
    };
    if (type == "float" || type == "float32") return as(float{});
    if (size == 8) return as(double{});
    const bool is_signed = type[0] != 'u';
    if (size == 1) return is_signed ? as(std::int8_t{}) : as(std::uint8_t{});
    if (size == 2) return is_signed ? as(std::int16_t{}) : as(std::uint16_t{});
    return is_signed ? as(std::int32_t{}) : as(std::uint32_t{});
  }

  void check_length(double count, const Element& element) const {
    if (count >= 0.0 && count <= static_cast<double>(bytes_.size())) return;
    fail(fmt::format("a list of element '{}' announces {:g} values, more than the file can hold",
                     element.name, count));
  }

  void skip_binary(const Element& element) {
    for (const Property& property : element.properties) {
      double count = 1.0;
      if (!property.count.empty()) {
        count = length(property.count);
        check_length(count, element);
      }
      skip_bytes(std::floor(count) * static_cast<double>(size_of(property.type)));
    }
  }

  /// As the format has it, each element on a line of its own: then assimp reads what is read here.
  void skip_line(const Element& element) {
    std::string_view text = line();
    while (text.rfind("comment", 0) == 0) text = line();
    const auto word = [&] {
      text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
      const std::string_view next = text.substr(0, text.find_first_of(" \t"));
      text.remove_prefix(next.size());
      if (next.empty()) fail(fmt::format("an element '{}' ends too early", element.name));
      return next;
    };
    for (const Property& property : element.properties) {
      double count = 1.0;
      if (!property.count.empty()) {
        const std::string_view number = word();
        const auto read = std::from_chars(number.data(), number.data() + number.size(), count);
        if (read.ec != std::errc()) count = -1.0;
        check_length(count, element);
      }
      for (double k = 0.0; k < count; k += 1.0) word();
    }
    if (element.properties.empty() || text.find_first_not_of(" \t") == std::string_view::npos) {
      return;
    }
    fail(fmt::format("an element '{}' has more values than its properties", element.name));
  }

  const std::string& path_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool is_binary_ = false, is_swapped_ = false;
  std::vector<Element> elements_;
};

}  // namespace

void check_ply(const std::string& path, std::string_view bytes) { Check(path, bytes).run(); }

}  // namespace pliant
