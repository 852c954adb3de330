#include "pliant/elements/tetrahedron_set.h"

#include "pliant/elements/principal_stretches.h"
#include "pliant/math/rotation_eigen.h"

namespace pliant {

double NearestRotationLaw::energy(const Eigen::Matrix3d& g) const {
  return (g - nearest_rotation(g).toRotationMatrix()).squaredNorm();
}

Eigen::Matrix3d NearestRotationLaw::stress(const Eigen::Matrix3d& g) const {
  return 2.0 * (g - nearest_rotation(g).toRotationMatrix());
}

Matrix9d NearestRotationLaw::tangent(const Eigen::Matrix3d& g, Definiteness definiteness) const {
  // p = (1, 1, 1): only the twists are left, with eigenvalues 2 (1 - 2 / (σᵢ + σⱼ)).
  const PrincipalStretches stretches = principal_stretches(g);
  StretchSlope slope{Eigen::Matrix3d::Zero(), Eigen::Vector3d::Zero(), {}};
  slope.twist = twist_slopes(stretches.sigma, Eigen::Vector3d::Ones());
  return 2.0 * distance_tangent(stretches, slope, definiteness);
}

TetrahedronSet::TetrahedronSet(const TetrahedralMesh& rest, double stiffness)
    : TetrahedronSet(rest, Eigen::VectorXd::Constant(rest.tetrahedra.cols(), stiffness)) {}

TetrahedronSet::TetrahedronSet(const TetrahedralMesh& rest, const Eigen::VectorXd& stiffness)
    : SimplexSet("tetrahedron", make_tetrahedra("tetrahedron", rest, stiffness), {}) {}

}  // namespace pliant
