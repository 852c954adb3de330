#ifndef PLIANT_GEOMETRY_POLYGON_H_
#define PLIANT_GEOMETRY_POLYGON_H_

#include <Eigen/Core>
#include <array>
#include <vector>

namespace pliant {

// Cuts a simple polygon, convex or not, flat or nearly so, into n - 2 triangles of the same winding
// without adding vertices. They are positions in `corners` (any unit). A polygon that crosses
// itself or has no area gives n - 2 triangles too, whatever they look like.
std::vector<std::array<int, 3>> triangulate_polygon(const std::vector<Eigen::Vector3d>& corners);

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_POLYGON_H_
