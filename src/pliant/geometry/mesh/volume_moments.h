#pragma once

#include <Eigen/Core>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// Where the volume of a solid shape lies.
struct VolumeMoments {
  double volume = 0.0;                               ///< ∫ dV [m³]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< ∫ x dV / V [m]
  /// ∫ (x − c)(x − c)ᵀ dV [m⁵].
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

/// Of a closed mesh whose triangles turn outward, by the signed tetrahedra between its triangles
/// and a point (exact for its flat faces).
VolumeMoments volume_moments(const TriangleMesh& mesh);

// Of primitive shapes about the origin, closed forms; along z. Lengths [m].
VolumeMoments sphere_moments(double radius);
VolumeMoments box_moments(const Eigen::Vector3d& size);
VolumeMoments cylinder_moments(double radius, double length);
/// `length` is that of the cylinder between the half spheres.
VolumeMoments capsule_moments(double radius, double length);

}  // namespace pliant
