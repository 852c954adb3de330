#include "pliant/geometry/io/tetrahedral_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <iterator>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/io/gmsh_file.h"
#include "pliant/geometry/io/readable_file.h"
#include "pliant/geometry/io/tetgen_file.h"

namespace pliant {
namespace {

MeshWithMaterial read_unchecked(const std::string& path) {
  const std::string extension = checked_extension(path, {"msh", "node", "ele", "veg"});
  if (extension == "veg") return read_veg(path, read_bytes(path));
  if (extension == "msh") {
    const std::string bytes = read_bytes(path);
    NumberStream stream(path, bytes);
    return {read_gmsh(stream), {}};
  }
  std::filesystem::path node(path), ele(path);
  node.replace_extension(".node");
  ele.replace_extension(".ele");
  checked_extension(node.string(), {"node"});
  checked_extension(ele.string(), {"ele"});
  const std::string node_bytes = read_bytes(node.string()), ele_bytes = read_bytes(ele.string());
  NumberStream node_file(node.string(), node_bytes), ele_file(ele.string(), ele_bytes);
  return {read_tetgen(node_file, ele_file), {}};
}

}  // namespace

MeshWithMaterial read_tetrahedral_file(const std::string& path) {
  MeshWithMaterial file = read_unchecked(path);
  validate(file.mesh, fmt::format("mesh '{}' (its tetrahedra counted from 0)", path));
  return file;
}

void write_msh(const std::string& path, const TetrahedralMesh& mesh) {
  const auto vertices = mesh.vertices.cols(), tetrahedra = mesh.tetrahedra.cols();
  std::string text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "$Nodes\n1 {0} 1 {0}\n3 1 0 {0}\n", vertices);
  for (Eigen::Index v = 0; v < vertices; ++v) fmt::format_to(out, "{}\n", v + 1);
  for (const auto v : mesh.vertices.colwise()) {
    fmt::format_to(out, "{} {} {}\n", v[0], v[1], v[2]);
  }
  fmt::format_to(out, "$EndNodes\n$Elements\n1 {0} 1 {0}\n3 1 4 {0}\n", tetrahedra);
  for (Eigen::Index t = 0; t < tetrahedra; ++t) {
    const auto v = mesh.tetrahedra.col(t);
    fmt::format_to(out, "{} {} {} {} {}\n", t + 1, v[0] + 1, v[1] + 1, v[2] + 1, v[3] + 1);
  }
  text += "$EndElements\n";
  write_file_atomically(path, text);
}

}  // namespace pliant
