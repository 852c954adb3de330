#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "pliant/geometry/io/number_stream.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// The mesh of these, in their order, without vertices that are in no tetrahedron, inverted
/// tetrahedra wound the right way. Each index has its vertex.
TetrahedralMesh used_mesh(const std::vector<Eigen::Vector3d>& positions,
                          const std::vector<Eigen::Vector4i>& tetrahedra);

/// Gathers the vertices and tetrahedra of a file that numbers its vertices as it likes. What does
/// not fit is refused at the place where the stream stands.
class NumberedMesh {
 public:
  explicit NumberedMesh(const NumberStream& stream) : stream_(&stream) {}

  /// For what follows from another file.
  void read_from(const NumberStream& stream) { stream_ = &stream; }
  void add_vertex(std::int64_t number, const Eigen::Vector3d& position);
  void add_tetrahedron(std::int64_t number, const std::array<std::int64_t, 4>& vertices);

  /// used_mesh() in the file's order.
  TetrahedralMesh finish() const { return used_mesh(positions_, tetrahedra_); }

 private:
  const NumberStream* stream_;
  std::unordered_map<std::int64_t, int> place_;  ///< of each vertex number
  std::vector<Eigen::Vector3d> positions_;
  std::vector<Eigen::Vector4i> tetrahedra_;
};

}  // namespace pliant
