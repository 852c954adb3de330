#include "pliant/geometry/io/numbered_mesh.h"

#include <fmt/format.h>

namespace pliant {

TetrahedralMesh used_mesh(const std::vector<Eigen::Vector3d>& positions,
                          const std::vector<Eigen::Vector4i>& tetrahedra) {
  constexpr int kUnused = -1;
  std::vector<int> vertex(positions.size(), kUnused);
  for (const Eigen::Vector4i& t : tetrahedra) {
    for (int k = 0; k < 4; ++k) vertex[static_cast<std::size_t>(t[k])] = 0;
  }
  int count = 0;
  for (int& v : vertex) {
    if (v != kUnused) v = count++;
  }
  TetrahedralMesh mesh;
  mesh.vertices.resize(3, count);
  for (std::size_t v = 0; v < vertex.size(); ++v) {
    if (vertex[v] != kUnused) mesh.vertices.col(vertex[v]) = positions[v];
  }
  mesh.tetrahedra.resize(4, static_cast<Eigen::Index>(tetrahedra.size()));
  for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      mesh.tetrahedra(k, static_cast<Eigen::Index>(t)) =
          vertex[static_cast<std::size_t>(tetrahedra[t][k])];
    }
  }
  fix_winding(mesh);
  return mesh;
}

void NumberedMesh::add_vertex(std::int64_t number, const Eigen::Vector3d& position) {
  if (!place_.try_emplace(number, static_cast<int>(positions_.size())).second) {
    stream_->fail(fmt::format("vertex {} is there twice", number));
  }
  if (!position.allFinite()) stream_->fail(fmt::format("vertex {} is not finite", number));
  positions_.push_back(position);
}

void NumberedMesh::add_tetrahedron(std::int64_t number,
                                   const std::array<std::int64_t, 4>& vertices) {
  if (tetrahedra_.size() == static_cast<std::size_t>(kMaxTetrahedra)) {
    stream_->fail(fmt::format("more than {} tetrahedra, the most allowed", kMaxTetrahedra));
  }
  Eigen::Vector4i places;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto found = place_.find(vertices[k]);
    if (found == place_.end()) {
      stream_->fail(
          fmt::format("tetrahedron {} names vertex {}, which there is none", number, vertices[k]));
    }
    places[static_cast<Eigen::Index>(k)] = found->second;
  }
  tetrahedra_.push_back(places);
}

}  // namespace pliant
