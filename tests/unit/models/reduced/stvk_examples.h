#pragma once

#include <vector>

#include "pliant/models/reduced/stvk_body.h"
#include "support/random.h"

namespace pliant {

/// The vertices of a block's face at the smallest x.
inline std::vector<int> face_vertices(const TetrahedralMesh& mesh) {
  const double low = mesh.vertices.row(0).minCoeff(), high = mesh.vertices.row(0).maxCoeff();
  std::vector<int> found;
  for (int v = 0; v < static_cast<int>(mesh.vertices.cols()); ++v) {
    if (mesh.vertices(0, v) < low + 1e-9 * (high - low)) found.push_back(v);
  }
  return found;
}

/// A block that is fixed at one end.
inline StvkBody cantilever(const BlockOptions& block, const ElasticMaterial& material,
                           bool averaged = false) {
  const TetrahedralMesh mesh = make_block(block);
  return StvkBody(mesh, material, face_vertices(mesh), "cantilever", averaged);
}

/// 3 x 2 x 2 vertices, 8 of them free: small enough for a basis of all motions.
inline StvkBody small_cantilever(bool averaged = false) {
  return cantilever({{0.4, 0.2, 0.3}, {2, 1, 1}}, {1e5, 0.3, 1000.0}, averaged);
}

inline Eigen::VectorXd random_vector(int size, double bound, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd v(size);
  for (int i = 0; i < size; ++i) v[i] = random(-bound, bound);
  return v;
}

inline bool go_on(double, double, const std::string&) { return true; }

}  // namespace pliant
