#include "pliant/geometry/distance/mesh_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/math/error.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr int kMargin = 4;               // samples around the mesh
constexpr double kDefaultVoxels = 64.0;  // along the longest side
constexpr double kMaxSamples = 30e6;

void refuse_open(const TriangleMesh& mesh) {
  const Edges all = edges(mesh);
  const auto open = std::count_if(all.opposite.begin(), all.opposite.end(),
                                  [](const std::array<int, 2>& o) { return o[1] < 0; });
  if (open == 0) return;
  throw InputError(fmt::format(
      "mesh shape: the mesh is open, it has {} boundary edges: close it, or it has no inside",
      open));
}

// Closed, its winding consistent and outward.
TriangleMesh checked_solid(TriangleMesh mesh) {
  try {
    validate(mesh, "mesh shape");
  } catch (const InputError&) {
    // Wrong winding is the one fault that can be mended.
    if (!orient_consistently(mesh)) throw;
    validate(mesh, "mesh shape");
  }
  refuse_open(mesh);
  if (signed_volume(mesh) < 0.0) mesh.triangles.row(1).swap(mesh.triangles.row(2));
  return mesh;
}

}  // namespace

DistanceGrid lay_grid(const Eigen::AlignedBox3d& bounds, double voxel_size) {
  const double longest = bounds.sizes().maxCoeff();
  if (!std::isfinite(voxel_size) || voxel_size < 0.0 || voxel_size > longest) {
    throw InputError(fmt::format(
        "mesh shape: voxel_size is {} m: allowed is (0, {}], or 0 for 1/64 of the longest side",
        voxel_size, longest));
  }
  DistanceGrid grid;
  grid.spacing = voxel_size > 0.0 ? voxel_size : longest / kDefaultVoxels;
  const Eigen::Array3d count = (bounds.sizes() / grid.spacing).array().ceil() + 1.0 + 2.0 * kMargin;
  if (count.prod() > kMaxSamples) {
    throw InputError(fmt::format(
        "mesh shape: voxel_size {} m asks for {:.3g} samples: at most {:.3g} are allowed",
        grid.spacing, count.prod(), kMaxSamples));
  }
  grid.count = count.cast<int>();
  grid.origin = bounds.center() - 0.5 * grid.spacing * (grid.count - 1).cast<double>().matrix();
  return grid;
}

bool has_inside(const DistanceGrid& grid) {
  return *std::min_element(grid.samples.begin(), grid.samples.end()) < 0.0f;
}

MeshShape::MeshShape(TriangleMesh mesh, const MeshShapeOptions& options)
    : mesh_(checked_solid(std::move(mesh))),
      bounds_(mesh_.vertices.rowwise().minCoeff(), mesh_.vertices.rowwise().maxCoeff()),
      grid_(lay_grid(bounds_, options.voxel_size)) {
  sample_signed_distance(mesh_, grid_);
  if (has_inside(grid_)) return;
  throw InputError(fmt::format(
      "mesh shape: the solid is too thin for samples {} m apart: choose a smaller voxel_size",
      grid_.spacing));
}

MeshShape::MeshShape(TriangleMesh surface, DistanceGrid grid)
    : mesh_(std::move(surface)),
      bounds_(mesh_.vertices.rowwise().minCoeff(), mesh_.vertices.rowwise().maxCoeff()),
      grid_(std::move(grid)) {}

MeshShape::Cell MeshShape::find_cell(const Vector3d& p) const {
  Cell cell;
  std::size_t index = 0;
  for (int k = 2; k >= 0; --k) {
    const double last = grid_.count[k] - 1;
    const double at = (p[k] - grid_.origin[k]) / grid_.spacing;
    const double within = at > 0.0 ? std::min(at, last) : 0.0;  // 0 for NaN
    const int low = std::min(static_cast<int>(within), grid_.count[k] - 2);
    cell.fraction[k] = within - low;
    cell.beyond[k] = at == within ? 0.0 : (at - within) * grid_.spacing;
    index = index * grid_.count[k] + low;
  }
  cell.corner = grid_.samples.data() + index;
  return cell;
}

SurfacePoint MeshShape::interpolate(const Cell& cell) const {
  const std::size_t row = grid_.count[0];
  const std::size_t layer = row * grid_.count[1];
  const double u = cell.fraction.x(), v = cell.fraction.y(), w = cell.fraction.z();
  // Along x first; names say whether y and z are low or high.
  const float* c = cell.corner;
  const double dx_ll = c[1] - c[0];
  const double dx_hl = c[row + 1] - c[row];
  const double dx_lh = c[layer + 1] - c[layer];
  const double dx_hh = c[layer + row + 1] - c[layer + row];
  const double ll = c[0] + u * dx_ll;
  const double hl = c[row] + u * dx_hl;
  const double lh = c[layer] + u * dx_lh;
  const double hh = c[layer + row] + u * dx_hh;
  const double low = ll + v * (hl - ll);
  const double high = lh + v * (hh - lh);
  const double dx_low = dx_ll + v * (dx_hl - dx_ll);
  const double dx_high = dx_lh + v * (dx_hh - dx_lh);
  const double dy_low = hl - ll;
  const double dy_high = hh - lh;
  return {low + w * (high - low),
          Vector3d(dx_low + w * (dx_high - dx_low), dy_low + w * (dy_high - dy_low), high - low)};
}

SurfacePoint MeshShape::query(const Vector3d& p) const {
  const Cell cell = find_cell(p);
  SurfacePoint result = interpolate(cell);
  const double steepness = result.normal.norm();
  // Flat in the middle of the solid, where any direction leads out.
  if (steepness > 1e-6 * grid_.spacing) {
    result.normal /= steepness;
  } else {
    result.normal = Vector3d::UnitZ();
  }
  const double beyond = cell.beyond.norm();
  if (beyond > 0.0) {
    // Seen from a point beyond the grid, the whole mesh lies behind the grid's side, so that
    // distance² >= beyond² + (distance at the side)². The direction is that from the point which
    // is nearest to the side.
    result.normal = (cell.beyond + result.distance * result.normal).normalized();
    result.distance = std::hypot(beyond, result.distance);
  }
  return result;
}

}  // namespace pliant
