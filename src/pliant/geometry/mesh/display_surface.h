#ifndef PLIANT_GEOMETRY_DISPLAY_SURFACE_H_
#define PLIANT_GEOMETRY_DISPLAY_SURFACE_H_

#include <Eigen/Core>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

// Surfaces of the primitive shapes for display: outward winding, round ones inscribed. Lengths [m]
// are expected to be checked already.

// In the plane z = 0, seen from +z.
TriangleMesh square_surface(double side);

TriangleMesh box_surface(const Eigen::Vector3d& half_size);

// Along z, centred at the origin; a sphere for length 0.
TriangleMesh capsule_surface(double radius, double length);

TriangleMesh cylinder_surface(double radius, double length);

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_DISPLAY_SURFACE_H_
