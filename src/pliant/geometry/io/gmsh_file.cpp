#include "pliant/geometry/io/gmsh_file.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {
namespace {

constexpr int kLinearTetrahedron = 4;

struct ElementType {
  int nodes;
  int dimension;
  const char* name;
};

/// Gmsh's element types by number (Gmsh reference manual, "Node ordering" and "MSH file format").
ElementType element_type(std::int64_t type, const NumberStream& stream) {
  static const std::array<ElementType, 18> kTypes = {{{2, 1, "line"},
                                                      {3, 2, "triangle"},
                                                      {4, 2, "quadrangle"},
                                                      {4, 3, "tetrahedron"},
                                                      {8, 3, "hexahedron"},
                                                      {6, 3, "prism"},
                                                      {5, 3, "pyramid"},
                                                      {3, 1, "second-order line"},
                                                      {6, 2, "second-order triangle"},
                                                      {9, 2, "second-order quadrangle"},
                                                      {10, 3, "second-order tetrahedron"},
                                                      {27, 3, "second-order hexahedron"},
                                                      {18, 3, "second-order prism"},
                                                      {14, 3, "second-order pyramid"},
                                                      {1, 0, "point"},
                                                      {8, 2, "second-order quadrangle"},
                                                      {20, 3, "second-order hexahedron"},
                                                      {15, 3, "second-order prism"}}};
  if (type < 1 || type > static_cast<std::int64_t>(kTypes.size())) {
    stream.fail(
        fmt::format("element type {} is unknown: allowed are points, lines, faces and "
                    "linear tetrahedra (type {})",
                    type, kLinearTetrahedron));
  }
  return kTypes[static_cast<std::size_t>(type - 1)];
}

class GmshReader {
 public:
  explicit GmshReader(NumberStream& stream) : in_(stream), mesh_(stream) {}

  TetrahedralMesh read() {
    read_format();
    bool has_nodes = false, has_elements = false;
    while (!in_.at_end()) {
      const std::string section(in_.line());
      if (section.size() < 2 || section[0] != '$') {
        in_.fail(
            fmt::format("'{}' should be the name of a section, as $Nodes", section.substr(0, 40)));
      }
      if (section == "$Nodes") {
        is_new_ ? read_nodes_41() : read_nodes_22();
        has_nodes = true;
      } else if (section == "$Elements") {
        if (!has_nodes) in_.fail("$Elements stands before $Nodes");
        is_new_ ? read_elements_41() : read_elements_22();
        has_elements = true;
      }
      in_.set_binary(false);
      in_.skip_past_line("$End" + section.substr(1));
    }
    if (!has_elements) in_.fail("the file has no $Elements");
    return mesh_.finish();
  }

 private:
  void read_format() {
    if (in_.line() != "$MeshFormat") in_.fail("a Gmsh file begins with $MeshFormat");
    const double version = in_.real();
    if (version != 2.2 && version != 4.1) {
      in_.fail(
          fmt::format("format version {}: allowed are 2.2 and 4.1 (gmsh -format msh41)", version));
    }
    is_new_ = version == 4.1;
    is_binary_ = in_.count("file type", 1, false) == 1;
    const std::int64_t size = in_.integer32();
    if (size != 8) in_.fail(fmt::format("data size {}: allowed is 8", size));
    in_.skip_line();
    if (is_binary_) {
      in_.set_binary(true);
      if (in_.integer32() != 1) in_.fail("the file is big-endian: write it as text");
      in_.set_binary(false);
    }
    in_.skip_past_line("$EndMeshFormat");
  }

  /// Counts are text in binary files of 2.2, and binary in those of 4.1.
  std::int64_t count(const char* what) { return in_.count(what, in_.left(), true); }

  void read_nodes_22() {
    const std::int64_t nodes = count("nodes");
    if (is_binary_) in_.skip_line();
    in_.set_binary(is_binary_);
    for (std::int64_t i = 0; i < nodes; ++i) {
      const std::int64_t number = in_.integer32();
      mesh_.add_vertex(number, position());
    }
  }

  void read_elements_22() {
    const std::int64_t elements = count("elements");
    if (is_binary_) in_.skip_line();
    in_.set_binary(is_binary_);
    for (std::int64_t i = 0; i < elements;) {
      // Text: number, type, tags, ...; binary: type, how many follow, tags, then each number, ...
      std::int64_t number = is_binary_ ? 0 : in_.integer32();
      const std::int64_t type = in_.integer32();
      const std::int64_t follow = is_binary_ ? in_.count("elements", elements - i, false) : 1;
      if (follow == 0) in_.fail("a block of no elements");
      const std::int64_t tags = in_.count("tags", in_.left(), false);
      for (std::int64_t k = 0; k < follow; ++k, ++i) {
        if (is_binary_) number = in_.integer32();
        for (std::int64_t tag = 0; tag < tags; ++tag) in_.integer32();
        read_element(number, type, false);
      }
    }
  }

  void read_nodes_41() {
    in_.set_binary(is_binary_);
    const std::int64_t blocks = count("blocks");
    for (int k = 0; k < 3; ++k) in_.integer64();  // nodes, least and greatest number
    for (std::int64_t b = 0; b < blocks; ++b) {
      const std::int64_t dimension = in_.count("dimensions", 3, false);
      in_.integer32();  // the entity
      const bool is_parametric = in_.count("parametric", 1, false) == 1;
      std::vector<std::int64_t> numbers(static_cast<std::size_t>(count("nodes")));
      for (std::int64_t& number : numbers) number = in_.integer64();
      for (const std::int64_t number : numbers) {
        mesh_.add_vertex(number, position());
        for (std::int64_t k = 0; is_parametric && k < dimension; ++k) in_.real();
      }
    }
  }

  void read_elements_41() {
    in_.set_binary(is_binary_);
    const std::int64_t blocks = count("blocks");
    for (int k = 0; k < 3; ++k) in_.integer64();  // elements, least and greatest number
    for (std::int64_t b = 0; b < blocks; ++b) {
      in_.integer32();  // the entity's dimension
      in_.integer32();  // the entity
      const std::int64_t type = in_.integer32();
      const std::int64_t elements = count("elements");
      for (std::int64_t i = 0; i < elements; ++i) {
        const std::int64_t number = in_.integer64();
        read_element(number, type, true);
      }
    }
  }

  void read_element(std::int64_t number, std::int64_t type, bool wide) {
    const ElementType kind = element_type(type, in_);
    if (kind.dimension == 3 && type != kLinearTetrahedron) {
      in_.fail(
          fmt::format("element {} is a {} (type {}): of volume elements only linear "
                      "tetrahedra (type {}) are read",
                      number, kind.name, type, kLinearTetrahedron));
    }
    std::array<std::int64_t, 4> nodes{};
    for (int k = 0; k < kind.nodes; ++k) {
      const std::int64_t node = wide ? in_.integer64() : in_.integer32();
      if (type == kLinearTetrahedron) nodes[static_cast<std::size_t>(k)] = node;
    }
    if (type == kLinearTetrahedron) mesh_.add_tetrahedron(number, nodes);
  }

  Eigen::Vector3d position() {
    const double x = in_.real(), y = in_.real();
    return {x, y, in_.real()};
  }

  NumberStream& in_;
  NumberedMesh mesh_;
  bool is_new_ = false;     ///< 4.1, not 2.2
  bool is_binary_ = false;  ///< after the format section
};

}  // namespace

TetrahedralMesh read_gmsh(NumberStream& stream) { return GmshReader(stream).read(); }

}  // namespace pliant
