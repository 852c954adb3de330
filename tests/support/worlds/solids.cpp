#include "support/worlds/solids.h"

#include <cmath>

#include "pliant/elements/solids/tetrahedron_set.h"
#include "pliant/elements/solids/volume_set.h"
#include "support/random.h"

namespace pliant {

std::vector<std::unique_ptr<ElementSet>> make_solid(const TetrahedralMesh& rest,
                                                    const ElasticMaterial& material) {
  const TetrahedronStiffness stiffness = tetrahedron_stiffness(material);
  std::vector<std::unique_ptr<ElementSet>> sets;
  sets.push_back(std::make_unique<TetrahedronSet>(rest, stiffness.corotated));
  if (stiffness.volume > 0.0) sets.push_back(std::make_unique<VolumeSet>(rest, stiffness.volume));
  return sets;
}

std::vector<const ElementSet*> pointers(const std::vector<std::unique_ptr<ElementSet>>& sets) {
  std::vector<const ElementSet*> result;
  for (const auto& set : sets) result.push_back(set.get());
  return result;
}

bool on_face(const TetrahedralMesh& block, int vertex, int axis, int side) {
  const auto row = block.vertices.row(axis);
  const double at = side < 0 ? row.minCoeff() : row.maxCoeff();
  return std::abs(row[vertex] - at) < 1e-9 * (row.maxCoeff() - row.minCoeff());
}

bool on_boundary(const TetrahedralMesh& block, int vertex) {
  for (int axis = 0; axis < 3; ++axis) {
    if (on_face(block, vertex, axis, -1) || on_face(block, vertex, axis, 1)) return true;
  }
  return false;
}

TetrahedralMesh jittered_block(const BlockOptions& options, double share) {
  Random random(21);
  TetrahedralMesh mesh = make_block(options);
  const Eigen::Vector3d cell = options.size.array() / options.cells.cast<double>().array();
  for (int i = 0; i < mesh.vertices.cols(); ++i) {
    const Eigen::Vector3d off = share * cell.cwiseProduct(random.vector(1.0));
    if (!on_boundary(mesh, i)) mesh.vertices.col(i) += off;
  }
  return mesh;
}

}  // namespace pliant
