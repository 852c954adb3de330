#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <type_traits>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/io/mesh_file.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Fields = std::map<std::string, Eigen::VectorXd>;

void check_field(const std::string& path, const std::string& name, Eigen::Index size,
                 Eigen::Index vertices) {
  const bool is_word = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return c == '_' || (c < 128 && std::isalnum(c));
  });
  if (!is_word || name == "x" || name == "y" || name == "z") {
    throw InputError(fmt::format(
        "mesh '{}': field name '{}': allowed are words of [A-Za-z0-9_] other than x, y, z", path,
        name));
  }
  if (size != vertices) {
    throw InputError(fmt::format("mesh '{}': field '{}' has {} values for {} vertices", path, name,
                                 size, vertices));
  }
}

template <typename Number>
void append(std::string& bytes, Number number) {
  static_assert(std::is_arithmetic_v<Number> && sizeof(Number) <= 4);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &number, sizeof(number));
  for (std::size_t i = 0; i < sizeof(number); ++i) {
    bytes.push_back(static_cast<char>(bits >> (8 * i) & 0xFF));
  }
}

std::string ply_header(const TriangleMesh& mesh, const Fields& fields, const std::string& comment) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  if (!comment.empty()) header += "comment " + comment + "\n";
  header += fmt::format(
      "element vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n",
      mesh.vertices.cols());
  for (const auto& field : fields) header += fmt::format("property float {}\n", field.first);
  header += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                        mesh.triangles.cols());
  return header;
}

}  // namespace

void write_ply(const std::string& path, const TriangleMesh& mesh, const Fields& fields,
               const std::string& comment) {
  for (const auto& [name, values] : fields) {
    check_field(path, name, values.size(), mesh.vertices.cols());
  }
  std::string bytes = ply_header(mesh, fields, comment);
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    for (int k = 0; k < 3; ++k) append(bytes, static_cast<float>(mesh.vertices(k, v)));
    for (const auto& field : fields) append(bytes, static_cast<float>(field.second[v]));
  }
  for (const auto triangle : mesh.triangles.colwise()) {
    append(bytes, std::uint8_t{3});
    for (int k = 0; k < 3; ++k) append(bytes, std::int32_t{triangle[k]});
  }
  write_file_atomically(path, bytes);
}

void write_obj(const std::string& path, const TriangleMesh& mesh, const std::string& comment) {
  std::string text = comment.empty() ? "" : "# " + comment + "\n";
  for (const auto vertex : mesh.vertices.colwise()) {
    fmt::format_to(std::back_inserter(text), "v {} {} {}\n", vertex[0], vertex[1], vertex[2]);
  }
  for (const auto triangle : mesh.triangles.colwise()) {
    fmt::format_to(std::back_inserter(text), "f {} {} {}\n", triangle[0] + 1, triangle[1] + 1,
                   triangle[2] + 1);
  }
  write_file_atomically(path, text);
}

}  // namespace pliant
