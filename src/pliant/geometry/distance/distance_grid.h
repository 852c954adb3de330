#ifndef PLIANT_GEOMETRY_DISTANCE_GRID_H_
#define PLIANT_GEOMETRY_DISTANCE_GRID_H_

#include <Eigen/Core>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

// Samples of a signed distance at origin + spacing * (x, y, z), x in [0, count[0]) and so on.
struct DistanceGrid {
  Eigen::Vector3d origin;      // [m]
  double spacing;              // [m]
  Eigen::Array3i count;        // along x, y, z
  std::vector<float> samples;  // [m], negative inside, x fastest
};

// Fills grid.samples with the distances to a closed mesh that lies within the grid, three spacings
// or more from its sides. The sign comes from OpenVDB; parts of the solid that hold no sample and
// are thinner than a spacing are outside.
void sample_signed_distance(const TriangleMesh& mesh, DistanceGrid& grid);

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_DISTANCE_GRID_H_
