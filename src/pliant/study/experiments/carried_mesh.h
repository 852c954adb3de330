#pragma once

#include <string>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// A mesh that some of a body's particles carry, by where they are and how they have turned.
class CarriedMesh {
 public:
  /// How the turns of the carriers about a vertex become one.
  enum class Blend {
    kNearest,      ///< that of the nearest carrier alone
    kLinear,       ///< their mean by QLERP
    kExponential,  ///< their mean by the exponential map
  };
  /// `carriers` 3 x n [m], at rest as `mesh` is. Each vertex belongs to the eight nearest with the
  /// weights (1 − r²/r₉²)², r₉ the distance of the ninth, so that no weight jumps. Throws
  /// InputError for fewer than nine carriers.
  CarriedMesh(const TriangleMesh& mesh, const Eigen::Matrix3Xd& carriers);

  /// Vertices where carriers are at `x` and have turned by `turns` (x, y, z, w) since rest.
  Eigen::Matrix3Xd carry(const Eigen::Matrix3Xd& x, const Eigen::Matrix4Xd& turns,
                         Blend blend) const;

 private:
  static constexpr int kCarriers = 8;  // of a vertex
  Eigen::Matrix3Xd rest_, carriers_;
  Eigen::Matrix<int, kCarriers, Eigen::Dynamic> near_;  // the nearest first
  Eigen::Matrix<double, kCarriers, Eigen::Dynamic> weights_;
};

/// Root mean square of how much the angle between neighbouring triangles has changed [deg]: what
/// makes a carried mesh look faceted.
double rms_angle_change(const TriangleMesh& rest, const Eigen::Matrix3Xd& vertices);

}  // namespace pliant
