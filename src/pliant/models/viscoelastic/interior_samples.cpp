#include "pliant/models/viscoelastic/interior_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "pliant/core/system/neighbor_lists.h"
#include "pliant/geometry/distance/mesh_shape.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr double kMostPoints = 2e6;
constexpr int kSweeps = 40;
// In spacings: how far points repel each other, how far one sweep moves them, how near to the
// surface they come.
constexpr double kReach = 1.5;
constexpr double kFirstStep = 0.25;
constexpr double kNearest = 0.3;
// Of the grid that says where inside is, against the spacing and the longest side.
constexpr double kVoxel = 0.5;
constexpr double kMostVoxels = 200.0;

Eigen::Vector3d extents(const TriangleMesh& mesh) {
  if (mesh.vertices.cols() == 0) return Eigen::Vector3d::Zero();
  return mesh.vertices.rowwise().maxCoeff() - mesh.vertices.rowwise().minCoeff();
}

/// Cells of the box around the body; each holds a particle where it is inside.
double cells_of(const Eigen::Vector3d& size, double spacing) {
  return size.cwiseMax(spacing).prod() / (spacing * spacing * spacing);
}

class Random {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state_ >> 11) / 9007199254740992.0;
  }

 private:
  std::uint64_t state_ = 0x9e3779b97f4a7c15ull;
};

std::vector<Eigen::Vector3d> jittered(const MeshShape& shape, double spacing) {
  const Eigen::AlignedBox3d box = shape.bounds();
  const Eigen::Array3i cells = (box.sizes() / spacing).array().ceil().cast<int>();
  // The lattice lies in the middle of the box.
  const Eigen::Vector3d low = box.center() - 0.5 * spacing * cells.cast<double>().matrix();
  Random random;
  std::vector<Eigen::Vector3d> points;
  for (int z = 0; z < cells[2]; ++z) {
    for (int y = 0; y < cells[1]; ++y) {
      for (int x = 0; x < cells[0]; ++x) {
        const Eigen::Vector3d cell(x, y, z);
        const Eigen::Vector3d off(random(), random(), random());
        if (shape.distance(low + spacing * (cell + Eigen::Vector3d::Constant(0.5))) > 0.0) continue;
        points.emplace_back(low + spacing * (cell + 0.25 * Eigen::Vector3d::Ones() + 0.5 * off));
      }
    }
  }
  return points;
}

/// Moves every point away from the others and from the surface, by up to `step` [m].
void spread(const MeshShape& shape, double spacing, double step, NeighborLists& lists,
            Eigen::Matrix3Xd& x) {
  const double reach = kReach * spacing;
  lists.build(x, reach);
  const Eigen::Matrix3Xd before = x;
  const auto repulsion = [&](double r) { return (1.0 - r / reach) * (1.0 - r / reach); };
  lists.for_each_point([&](int rank, int i) {
    Eigen::Vector3d push = Eigen::Vector3d::Zero();
    lists.for_each_neighbor(rank, [&](int other) {
      const Eigen::Vector3d apart = before.col(i) - before.col(other);
      const double r = apart.norm();
      if (r > 0.0) push += repulsion(r) / r * apart;
    });
    const SurfacePoint surface = shape.query(before.col(i));
    const double depth = -surface.distance;
    if (2.0 * depth < reach) push -= repulsion(std::max(0.0, 2.0 * depth)) * surface.normal;
    if (push.norm() > 1.0) push.normalize();
    x.col(i) += step * push;
    const SurfacePoint end_point = shape.query(x.col(i));
    const double outside = end_point.distance + kNearest * spacing;
    if (outside > 0.0) x.col(i) -= outside * end_point.normal;
  });
}

}  // namespace

double least_particle_spacing(const TriangleMesh& mesh) {
  const Eigen::Vector3d size = extents(mesh);
  // From above: the number of cells falls as they grow.
  double low = 0.0, high = size.maxCoeff();
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (cells_of(size, middle) > kMostPoints ? low : high) = middle;
  }
  return high;
}

InteriorSamples sample_interior(const TriangleMesh& mesh, double spacing) {
  if (!(std::isfinite(spacing) && spacing > 0.0)) {
    throw InputError(
        fmt::format("spacing of particles is {} m, but must be positive and finite", spacing));
  }
  const Eigen::Vector3d size = extents(mesh);
  const double most = cells_of(size, spacing);
  if (most > kMostPoints) {
    throw InputError(fmt::format(
        "a spacing of {:g} m makes up to {:.3g} particles, but at most {:g} are allowed: take "
        "{:.3g} m or more",
        spacing, most, kMostPoints, least_particle_spacing(mesh)));
  }
  MeshShapeOptions options;
  options.voxel_size = std::max(kVoxel * spacing, size.maxCoeff() / kMostVoxels);
  options.voxel_size = std::min(options.voxel_size, size.maxCoeff() / 16.0);
  const MeshShape shape(mesh, options);
  const std::vector<Eigen::Vector3d> start = jittered(shape, spacing);
  if (start.empty()) {
    throw InputError(fmt::format(
        "a spacing of {:g} m leaves no particle inside the body: take a smaller one", spacing));
  }
  InteriorSamples samples;
  samples.volume = std::abs(signed_volume(shape.surface()));
  samples.points.resize(3, static_cast<Eigen::Index>(start.size()));
  for (std::size_t k = 0; k < start.size(); ++k) {
    samples.points.col(static_cast<Eigen::Index>(k)) = start[k];
  }
  const double own = std::cbrt(samples.volume / static_cast<double>(start.size()));
  NeighborLists lists;
  for (int k = 0; k < kSweeps; ++k) {
    const double step = kFirstStep * own * (1.0 - static_cast<double>(k) / kSweeps);
    spread(shape, own, step, lists, samples.points);
  }
  return samples;
}

}  // namespace pliant
