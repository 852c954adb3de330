#include "pliant/geometry/distance/distance_grid.h"

#include <cstddef>
#include <limits>

#include "pliant/geometry/distance/sample_blocks.h"
#include "pliant/geometry/distance/voxel_signs.h"
#include "pliant/geometry/search/mesh_distances.h"

namespace pliant {

void sample_signed_distance(const TriangleMesh& mesh, DistanceGrid& grid) {
  // In spacings from the grid's origin.
  TriangleMesh scaled = mesh;
  scaled.vertices = (mesh.vertices.colwise() - grid.origin) / grid.spacing;
  const std::vector<char> inside = samples_inside(scaled.vertices, mesh.triangles, grid.count);
  const MeshDistances mesh_distances(scaled);
  grid.samples.resize(inside.size());
  // OpenVDB's own distances are off by up to half a spacing outside its innermost band.
  for_each_block(grid.count, [&] {
    return [&, hint = -1](const auto& indices, const MeshDistances::Points& at) mutable {
      MeshDistances::Lanes distances;
      distances.fill(std::numeric_limits<double>::infinity());
      mesh_distances.lower(at, distances, hint);
      for (std::size_t l = 0; l < indices.size(); ++l) {
        const double distance = grid.spacing * distances[l];
        grid.samples[indices[l]] =
            static_cast<float>(inside[indices[l]] != 0 ? -distance : distance);
      }
    };
  });
}

}  // namespace pliant
