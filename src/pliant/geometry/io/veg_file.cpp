#include "pliant/geometry/io/veg_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/geometry/io/included_lines.h"
#include "pliant/geometry/io/numbered_mesh.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr const char* kAllElements = "allElements";
constexpr std::size_t kMostOfAKind = 1000;  // of materials, sets and regions

/// Its words, which spaces and commas separate.
std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kBetween = " ,\t\r";
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(kBetween); at != std::string_view::npos;
       at = line.find_first_not_of(kBetween, at)) {
    const std::size_t end = std::min(line.find_first_of(kBetween, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

/// "*MATERIAL rubber" -> *MATERIAL and rubber; spaces in names do not count there.
std::pair<std::string, std::string> split_heading(std::string_view line) {
  std::size_t end = 1;
  while (end < line.size() && std::isalpha(static_cast<unsigned char>(line[end])) != 0) ++end;
  std::string name(line.substr(end));
  name.erase(std::remove_if(name.begin(), name.end(),
                            [](unsigned char c) { return std::isspace(c) != 0; }),
             name.end());
  return {std::string(line.substr(0, end)), name};
}

/// Reads the sections, whatever their order, and then puts them together.
class VegReader {
 public:
  VegReader(const std::string& path, const std::string& bytes) : path_(path), lines_(path, bytes) {}

  MeshWithMaterial read() {
    while (lines_.next()) {
      if (lines_.line().front() != '*') fail("a section should begin here, *VERTICES or another");
      read_section();
    }
    if (!has_vertices_) refuse("there is no section *VERTICES");
    if (!has_elements_) refuse("there is no section *ELEMENTS");
    check_corners();
    return {used_mesh(positions_, tetrahedra_), material()};
  }

 private:
  struct Set {
    std::string name;
    std::vector<std::int64_t> elements;  // as numbered in the file
  };
  struct Region {
    std::string set, material;
  };

  [[noreturn]] void fail(const std::string& what) const { lines_.fail(what); }
  /// What no single line is at fault for.
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("mesh '{}': {}", path_, what));
  }

  template <class Number>
  Number number(std::string_view word, const char* wanted) const {
    Number value{};
    const char* first = word.data() + (word.size() > 1 && word[0] == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(first, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) {
      fail(fmt::format("'{}' should be {}", word.substr(0, 40), wanted));
    }
    return value;
  }
  std::int64_t whole(std::string_view word) const {
    return number<std::int64_t>(word, "a whole number");
  }
  double real(std::string_view word) const { return number<double>(word, "a number"); }

  /// The next line of a section; false where another section or the file's end is.
  bool next_of_section() {
    if (!lines_.next()) return false;
    if (lines_.line().front() != '*') return true;
    lines_.hold();
    return false;
  }
  void need_line(const std::string& what) {
    if (!next_of_section()) fail(fmt::format("the section ends before {}", what));
  }

  void read_section() {
    if (std::max({materials_.size(), sets_.size(), regions_.size()}) >= kMostOfAKind) {
      fail(fmt::format("more than {} materials, sets or regions", kMostOfAKind));
    }
    const auto [heading, name] = split_heading(lines_.line());
    if (heading == "*VERTICES") {
      read_vertices();
    } else if (heading == "*ELEMENTS") {
      read_elements();
    } else if (heading == "*MATERIAL") {
      read_material(name);
    } else if (heading == "*SET") {
      read_set(name);
    } else if (heading == "*REGION") {
      read_region();
    } else {
      fail(unknown_name_message("section", heading,
                                {"*VERTICES", "*ELEMENTS", "*MATERIAL", "*SET", "*REGION"}));
    }
  }

  /// "4 3 0 0": how many rows follow, how many numbers each has, and how many more.
  std::pair<std::int64_t, std::size_t> read_counts(const char* what, std::int64_t numbers) {
    need_line(fmt::format("the number of {}", what));
    const auto words = words_of(lines_.line());
    const std::int64_t rows = words.empty() ? -1 : whole(words[0]);
    const std::int64_t most = std::int64_t{4} * kMaxTetrahedra;
    if (rows < 1 || rows > most) {
      fail(fmt::format("the number of {} is {}: allowed is [1, {}]", what, rows, most));
    }
    if (words.size() > 1 && whole(words[1]) != numbers) {
      fail(fmt::format("{} numbers for each of the {}: allowed is {}", words[1], what, numbers));
    }
    std::size_t columns = 1 + static_cast<std::size_t>(numbers);
    constexpr std::int64_t kMostAttributes = 100;
    for (std::size_t k = 2; k < words.size(); ++k) {
      const std::int64_t more = whole(words[k]);
      if (more < 0 || more > kMostAttributes) {
        fail(fmt::format("{} attributes: allowed is [0, {}]", more, kMostAttributes));
      }
      columns += static_cast<std::size_t>(more);
    }
    return {rows, columns};
  }

  /// Calls row(words) for each of so many rows, which count up from 0 or 1: `first` is set to that.
  template <class Row>
  void read_rows(const char* what, std::int64_t count, std::size_t columns, std::int64_t& first,
                 const Row& row) {
    std::int64_t rows = 0;
    for (; next_of_section(); ++rows) {
      if (rows == count) fail(fmt::format("more than {} {}", count, what));
      const auto words = words_of(lines_.line());
      if (words.size() != columns) {
        fail(fmt::format("{} numbers where {} should be", words.size(), columns));
      }
      const std::int64_t own = whole(words[0]);
      if (rows == 0) first = own == 0 ? 0 : 1;
      if (own != first + rows) {
        fail(fmt::format("number {} where {} should be: {} are in order", own, first + rows, what));
      }
      row(words);
    }
    if (rows != count) fail(fmt::format("{} of {} {} are there", rows, count, what));
  }

  void read_vertices() {
    if (std::exchange(has_vertices_, true)) fail("*VERTICES is there twice");
    const auto [count, columns] = read_counts("vertices", 3);
    read_rows("vertices", count, columns, first_vertex_, [this](const auto& words) {
      const Eigen::Vector3d x(real(words[1]), real(words[2]), real(words[3]));
      if (!x.allFinite()) fail(fmt::format("vertex {} is not finite", words[0]));
      positions_.push_back(x);
    });
  }

  void read_elements() {
    if (std::exchange(has_elements_, true)) fail("*ELEMENTS is there twice");
    need_line("the kind of elements");
    const std::string kind(lines_.line());
    if (kind.compare(0, 5, "CUBIC") == 0) {
      fail("elements CUBIC: cubes are not read, only tetrahedra (TET)");
    }
    if (kind != "TET" && kind != "TETS") {
      fail(unknown_name_message("kind of elements", kind, {"TET", "TETS"}));
    }
    const auto [count, columns] = read_counts("elements", 4);
    if (count > kMaxTetrahedra) fail(fmt::format("more than {} tetrahedra", kMaxTetrahedra));
    read_rows("elements", count, columns, first_element_, [this](const auto& words) {
      std::array<std::int64_t, 4> corners{};
      for (std::size_t k = 0; k < 4; ++k) corners[k] = whole(words[k + 1]);
      corners_.push_back(corners);
    });
  }

  void read_material(const std::string& name) {
    if (name.empty()) fail("*MATERIAL has no name");
    if (materials_.count(name) > 0) fail(fmt::format("material '{}' is there twice", name));
    need_line("what the material is");
    const auto words = words_of(lines_.line());
    if (words.empty() || words[0] != "ENU") {
      fail(
          fmt::format("material '{}' is {}: only ENU is read (density, Young's modulus, Poisson's "
                      "ratio)",
                      name, words.empty() ? "empty" : words[0].substr(0, 40)));
    }
    if (words.size() != 4) fail(fmt::format("material '{}': ENU has three numbers", name));
    const FileMaterial material{name, real(words[1]), real(words[2]), real(words[3])};
    const auto check = [&](const char* what, double value, bool is_good, const char* range) {
      if (!is_good) {
        fail(fmt::format("material '{}': {} is {}, but must be {}", name, what, value, range));
      }
    };
    const auto is_positive = [](double x) { return x > 0.0 && std::isfinite(x); };
    check("density", material.density, is_positive(material.density), "> 0 [kg/m^3]");
    check("Young's modulus", material.young, is_positive(material.young), "> 0 [Pa]");
    check("Poisson's ratio", material.poisson, material.poisson > -1.0 && material.poisson < 0.5,
          "in (-1, 0.5)");
    materials_.emplace(name, material);
  }

  void read_set(const std::string& name) {
    if (name.empty()) fail("*SET has no name");
    if (name == kAllElements) fail("the set 'allElements' is there already: it is all of them");
    for (const Set& set : sets_) {
      if (set.name == name) fail(fmt::format("set '{}' is there twice", name));
    }
    sets_.push_back({name, {}});
    while (next_of_section()) {
      for (const std::string_view word : words_of(lines_.line())) {
        sets_.back().elements.push_back(whole(word));
      }
    }
  }

  void read_region() {
    need_line("a set and its material");
    const auto words = words_of(lines_.line());
    if (words.size() != 2) fail("a region is the name of a set, a comma and that of a material");
    regions_.push_back({std::string(words[0]), std::string(words[1])});
  }

  void check_corners() {
    const auto vertices = static_cast<std::int64_t>(positions_.size());
    for (std::size_t t = 0; t < corners_.size(); ++t) {
      Eigen::Vector4i places;
      for (int k = 0; k < 4; ++k) {
        const std::int64_t corner = corners_[t][static_cast<std::size_t>(k)];
        if (corner < first_vertex_ || corner - first_vertex_ >= vertices) {
          refuse(fmt::format("element {} names vertex {}, which there is none",
                             first_element_ + static_cast<std::int64_t>(t), corner));
        }
        places[k] = static_cast<int>(corner - first_vertex_);
      }
      tetrahedra_.push_back(places);
    }
  }

  /// Gives the elements of a region's set its material.
  void assign(const Region& region, const FileMaterial* material,
              std::vector<const FileMaterial*>& of_element) const {
    if (region.set == kAllElements) {
      std::fill(of_element.begin(), of_element.end(), material);
      return;
    }
    const auto set = std::find_if(sets_.begin(), sets_.end(),
                                  [&](const Set& s) { return s.name == region.set; });
    if (set == sets_.end()) refuse(fmt::format("a region names set '{}': none", region.set));
    for (const std::int64_t element : set->elements) {
      const std::int64_t place = element - first_element_;
      if (place < 0 || place >= static_cast<std::int64_t>(of_element.size())) {
        refuse(fmt::format("set '{}' names element {}, which there is none", region.set, element));
      }
      of_element[static_cast<std::size_t>(place)] = material;
    }
  }

  std::optional<FileMaterial> material() const {
    if (regions_.empty()) return std::nullopt;
    std::vector<const FileMaterial*> of_element(tetrahedra_.size(), nullptr);
    for (const Region& region : regions_) {
      const auto found = materials_.find(region.material);
      if (found == materials_.end()) {
        refuse(fmt::format("a region names material '{}': none", region.material));
      }
      assign(region, &found->second, of_element);
    }
    for (std::size_t t = 0; t < of_element.size(); ++t) {
      const std::int64_t own = first_element_ + static_cast<std::int64_t>(t);
      if (of_element[t] == nullptr) refuse(fmt::format("element {} is in no region", own));
      if (!is_same(*of_element[t], *of_element[0])) {
        refuse(
            fmt::format("elements {} and {} are of the materials '{}' and '{}', but a body has one",
                        first_element_, own, of_element[0]->name, of_element[t]->name));
      }
    }
    return *of_element[0];
  }

  static bool is_same(const FileMaterial& a, const FileMaterial& b) {
    return a.density == b.density && a.young == b.young && a.poisson == b.poisson;
  }

  std::string path_;
  IncludedLines lines_;
  bool has_vertices_ = false, has_elements_ = false;
  std::int64_t first_vertex_ = 1, first_element_ = 1;
  std::vector<Eigen::Vector3d> positions_;
  std::vector<std::array<std::int64_t, 4>> corners_;  // as numbered in the file
  std::vector<Eigen::Vector4i> tetrahedra_;
  std::map<std::string, FileMaterial> materials_;
  std::vector<Set> sets_;
  std::vector<Region> regions_;
};

}  // namespace

MeshWithMaterial read_veg(const std::string& path, const std::string& bytes) {
  return VegReader(path, bytes).read();
}

}  // namespace pliant
