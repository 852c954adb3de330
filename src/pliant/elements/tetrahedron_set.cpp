#include "pliant/elements/tetrahedron_set.h"

#include "pliant/elements/principal_stretches.h"
#include "pliant/math/rotation_batch.h"
#include "pliant/math/rotation_eigen.h"

namespace pliant {

void NearestRotationLaw::stresses(const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const {
  Matrix3<double> f[kStressBlock] = {};
  Quaternion<double> q[kStressBlock];
  for (int k = 0; k < count; ++k) f[k] = to_plain(g[k]);
  nearest_rotations_cold(f, q, count);
  for (int k = 0; k < count; ++k) p[k] = 2.0 * (g[k] - to_eigen(q[k]).toRotationMatrix());
}

Matrix9d NearestRotationLaw::tangent(const Eigen::Matrix3d& g, Definiteness definiteness) const {
  // p = (1, 1, 1): only the twists are left, with eigenvalues 2 (1 - 2 / (σᵢ + σⱼ)).
  const PrincipalStretches stretches = principal_stretches(g);
  StretchSlope slope{Eigen::Matrix3d::Zero(), Eigen::Vector3d::Zero(), {}};
  slope.twist = twist_slopes(stretches.sigma, Eigen::Vector3d::Ones());
  return 2.0 * distance_tangent(stretches, slope, definiteness);
}

TetrahedronSet::TetrahedronSet(const TetrahedralMesh& rest, double stiffness, int first_particle)
    : TetrahedronSet(rest, Eigen::VectorXd::Constant(rest.tetrahedra.cols(), stiffness),
                     first_particle) {}

TetrahedronSet::TetrahedronSet(const TetrahedralMesh& rest, const Eigen::VectorXd& stiffness,
                               int first_particle)
    : SimplexSet("tetrahedron", make_tetrahedra("tetrahedron", rest, stiffness, first_particle),
                 {}) {}

}  // namespace pliant
