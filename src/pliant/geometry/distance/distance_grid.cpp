#include "pliant/geometry/distance/distance_grid.h"

#include <cstddef>
#include <limits>
#include <utility>

#include "pliant/geometry/distance/sample_rows.h"
#include "pliant/geometry/distance/voxel_signs.h"
#include "pliant/geometry/search/nearest_triangle.h"

namespace pliant {

void sample_signed_distance(const TriangleMesh& mesh, DistanceGrid& grid) {
  // In spacings from the grid's origin.
  TriangleMesh scaled = mesh;
  scaled.vertices = (mesh.vertices.colwise() - grid.origin) / grid.spacing;
  const std::vector<char> inside = samples_inside(scaled.vertices, mesh.triangles, grid.count);
  const NearestTriangle nearest(std::move(scaled));
  grid.samples.resize(inside.size());
  // OpenVDB's own distances are off by up to half a spacing outside its innermost band.
  for_each_row(grid.count, [&] {
    return [&, hint = -1](std::size_t i, const Eigen::Vector3d& p) mutable {
      const double unlimited = std::numeric_limits<double>::infinity();
      const double distance = grid.spacing * nearest.distance(p, unlimited, hint);
      grid.samples[i] = static_cast<float>(inside[i] != 0 ? -distance : distance);
    };
  });
}

}  // namespace pliant
