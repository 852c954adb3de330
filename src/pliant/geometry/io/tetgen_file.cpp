#include "pliant/geometry/io/tetgen_file.h"

#include <fmt/format.h>

#include <array>

#include "pliant/geometry/io/numbered_mesh.h"

namespace pliant {
namespace {

/// Numbers and positions of the vertices; attributes and boundary markers are skipped.
void read_nodes(NumberStream& in, NumberedMesh& mesh) {
  const std::int64_t nodes = in.count("vertices", in.left(), false);
  const std::int64_t dimension = in.integer32();
  if (dimension != 3) in.fail(fmt::format("dimension {}: allowed is 3", dimension));
  const std::int64_t attributes = in.count("attributes", in.left(), false);
  const std::int64_t markers = in.count("boundary markers", 1, false);
  for (std::int64_t i = 0; i < nodes; ++i) {
    const std::int64_t number = in.integer32();
    const double x = in.real(), y = in.real();
    mesh.add_vertex(number, {x, y, in.real()});
    for (std::int64_t k = 0; k < attributes + markers; ++k) in.real();
  }
}

/// Attributes (regions) and the midpoints of second-order tetrahedra are skipped.
void read_elements(NumberStream& in, NumberedMesh& mesh) {
  const std::int64_t elements = in.count("tetrahedra", in.left(), false);
  const std::int64_t nodes = in.integer32();
  if (nodes != 4 && nodes != 10) {
    in.fail(
        fmt::format("{} vertices a tetrahedron: allowed are 4, or 10 of which the first 4 are "
                    "read",
                    nodes));
  }
  const std::int64_t attributes = in.count("attributes", in.left(), false);
  for (std::int64_t i = 0; i < elements; ++i) {
    const std::int64_t number = in.integer32();
    std::array<std::int64_t, 4> corners{};
    for (std::int64_t& corner : corners) corner = in.integer32();
    for (std::int64_t k = 4; k < nodes; ++k) in.integer32();
    for (std::int64_t k = 0; k < attributes; ++k) in.real();
    mesh.add_tetrahedron(number, corners);
  }
}

}  // namespace

TetrahedralMesh read_tetgen(NumberStream& node_file, NumberStream& ele_file) {
  NumberedMesh mesh(node_file);
  node_file.set_comments(true);
  ele_file.set_comments(true);
  read_nodes(node_file, mesh);
  mesh.read_from(ele_file);
  read_elements(ele_file, mesh);
  return mesh.finish();
}

}  // namespace pliant
