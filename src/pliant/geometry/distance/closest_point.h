#ifndef PLIANT_GEOMETRY_CLOSEST_POINT_H_
#define PLIANT_GEOMETRY_CLOSEST_POINT_H_

#include <Eigen/Core>

namespace pliant {

// The point of the triangle a, b, c nearest to p; same unit as the arguments. For triangles without
// area too.
Eigen::Vector3d closest_point_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                          const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_CLOSEST_POINT_H_
