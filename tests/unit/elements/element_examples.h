#pragma once

#include <memory>
#include <vector>

#include "pliant/elements/attachment_set.h"
#include "pliant/elements/cloth/bending_set.h"
#include "pliant/elements/cloth/cell_shear_set.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/elements/cloth/triangle_strain_set.h"
#include "pliant/elements/clusters/oriented_cluster_set.h"
#include "pliant/elements/solids/fiber_set.h"
#include "pliant/elements/solids/strain_limit_set.h"
#include "pliant/elements/solids/tetrahedron_set.h"
#include "pliant/elements/solids/volume_set.h"
#include "pliant/models/cloth/cloth_springs.h"
#include "support/random.h"

namespace pliant {

/// A set over particles about 0.1 m apart, stiff enough to push 1 g by centimetres in 1 ms.
struct ElementExample {
  Positions rest;
  std::unique_ptr<ElementSet> set;
};

/// `cells` along each edge decides on its size.
template <class Set>
ElementExample make_example(int cells);

inline GridOptions example_grid(int cells) {
  return {0.1 * cells, 0.08 * (cells + 1), cells + 1, cells + 2};
}

/// Every element of another shape.
inline TetrahedralMesh example_block(int cells) {
  Random random(5);
  TetrahedralMesh mesh = make_block({0.12 * Eigen::Vector3d(cells, cells, 1.0), {cells, cells, 1}});
  mesh.vertices += random.positions(static_cast<int>(mesh.vertices.cols()), 0.01);
  return mesh;
}

inline Eigen::VectorXd example_stiffness(const TetrahedralMesh& mesh, double mean) {
  Random random(6);
  Eigen::VectorXd stiffness(mesh.tetrahedra.cols());
  for (double& s : stiffness) s = mean * random(0.5, 1.5);
  return stiffness;
}

template <>
inline ElementExample make_example<SpringSet>(int cells) {
  const GridOptions grid = example_grid(cells);
  std::vector<Spring> springs = grid_stretch_springs(grid, {300.0, 200.0, 0.0});
  const std::vector<Spring> shear = grid_shear_springs(grid, 50.0, 2);
  springs.insert(springs.end(), shear.begin(), shear.end());
  const TriangleMesh mesh = make_grid(grid);
  const int particles = static_cast<int>(mesh.vertices.cols());
  return {mesh.vertices, std::make_unique<SpringSet>("stretch", springs, particles)};
}

template <>
inline ElementExample make_example<CellShearSet>(int cells) {
  const GridOptions grid = example_grid(cells);
  const TriangleMesh mesh = make_grid(grid);
  const int particles = static_cast<int>(mesh.vertices.cols());
  return {mesh.vertices, std::make_unique<CellShearSet>(grid_shear_cells(grid, 100.0), particles)};
}

template <>
inline ElementExample make_example<BendingSet>(int cells) {
  const TriangleMesh mesh = make_grid(example_grid(cells));
  return {mesh.vertices, std::make_unique<BendingSet>(mesh, 2e-3)};
}

template <>
inline ElementExample make_example<TetrahedronSet>(int cells) {
  const TetrahedralMesh mesh = example_block(cells);
  return {mesh.vertices, std::make_unique<TetrahedronSet>(mesh, example_stiffness(mesh, 500.0))};
}

template <>
inline ElementExample make_example<VolumeSet>(int cells) {
  const TetrahedralMesh mesh = example_block(cells);
  return {mesh.vertices, std::make_unique<VolumeSet>(mesh, example_stiffness(mesh, 1000.0))};
}

template <>
inline ElementExample make_example<StrainLimitSet>(int cells) {
  const TetrahedralMesh mesh = example_block(cells);
  return {mesh.vertices, std::make_unique<StrainLimitSet>(mesh, 1000.0, StretchLimits{0.95, 1.05})};
}

template <>
inline ElementExample make_example<FiberSet>(int cells) {
  const TetrahedralMesh mesh = example_block(cells);
  return {mesh.vertices, std::make_unique<FiberSet>(mesh, 1000.0, Eigen::Vector3d(2.0, -1.0, 0.5))};
}

template <>
inline ElementExample make_example<TriangleStrainSet>(int cells) {
  Random random(7);
  const TriangleMesh mesh = make_grid(example_grid(cells));
  MembraneMaterial material{300.0, 200.0, 50.0, 100.0, {0.95, 1.05}, {0.9, 1.1}};
  // Any direction within the plane.
  Positions warp = random.positions(static_cast<int>(mesh.triangles.cols()), 1.0);
  return {mesh.vertices, std::make_unique<TriangleStrainSet>(mesh, warp, material)};
}

/// Overlapping clusters of each cell's corners, and some that have no volume.
inline std::vector<Cluster> example_clusters(const GridOptions& grid) {
  std::vector<Cluster> clusters;
  const int across = grid.columns;
  for (int r = 0; r + 1 < grid.rows; ++r) {
    for (int c = 0; c + 1 < grid.columns; ++c) {
      const int i = r * across + c;
      clusters.push_back({{i, i + 1, i + across, i + across + 1}, 1e5});
    }
  }
  clusters.push_back({{0}, 1e5});
  clusters.push_back({{0, 1}, 1e5});
  clusters.push_back({{0, 1, 2}, 1e5});
  clusters.push_back({{0, across, 2 * across}, 2e5});
  return clusters;
}

/// A grid whose vertices stick out of its plane, apart from the first row and column.
inline Positions cluster_rest(const GridOptions& grid) {
  Random random(8);
  Positions rest = make_grid(grid).vertices;
  for (int i = grid.columns; i < rest.cols(); ++i) {
    if (i % grid.columns != 0) rest.col(i) += random.vector(0.02);
  }
  return rest;
}

template <>
inline ElementExample make_example<ClusterSet>(int cells) {
  const GridOptions grid = example_grid(cells);
  const Positions rest = cluster_rest(grid);
  const Eigen::VectorXd masses = Eigen::VectorXd::LinSpaced(rest.cols(), 0.5e-3, 1.5e-3);
  return {rest, std::make_unique<ClusterSet>(rest, masses, example_clusters(grid))};
}

template <>
inline ElementExample make_example<OrientedClusterSet>(int cells) {
  const GridOptions grid = example_grid(cells);
  const Positions rest = cluster_rest(grid);
  const Eigen::VectorXd masses = Eigen::VectorXd::LinSpaced(rest.cols(), 0.5e-3, 1.5e-3);
  std::vector<Eigen::Matrix3d> moments;
  for (double mass : masses) moments.push_back(ellipsoid_moment(mass, {0.05, 0.04, 0.03}));
  return {rest,
          std::make_unique<OrientedClusterSet>(rest, masses, moments, example_clusters(grid))};
}

template <>
inline ElementExample make_example<AttachmentSet>(int cells) {
  const Positions rest = make_grid(example_grid(cells)).vertices;
  auto set = std::make_unique<AttachmentSet>(static_cast<int>(rest.cols()));
  for (int i = 0; i < rest.cols(); i += 2) set->add(i, rest.col(i), 100.0 + i);
  return {rest, std::move(set)};
}

}  // namespace pliant
