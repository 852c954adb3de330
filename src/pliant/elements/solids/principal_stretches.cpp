#include "pliant/elements/solids/principal_stretches.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/math/rotation_eigen.h"
#include "pliant/math/symmetric_eigen3.h"

namespace pliant {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;

constexpr double kLargestTwist = 1e12;

Vector9d flat(const Eigen::Matrix3d& matrix) { return Eigen::Map<const Vector9d>(matrix.data()); }

/// The symmetric matrix, or the one nearest to it without negative eigenvalues.
Eigen::Matrix3d make_definite(const Eigen::Matrix3d& matrix, Definiteness definiteness) {
  if (definiteness == Definiteness::kExact) return matrix;
  const SymmetricEigen3 eigen = symmetric_eigen3(matrix);
  const Eigen::Matrix3d& q = eigen.vectors;
  return q * eigen.values.cwiseMax(0.0).asDiagonal() * q.transpose();
}

double make_definite(double eigenvalue, Definiteness definiteness) {
  return definiteness == Definiteness::kExact ? eigenvalue : std::max(eigenvalue, 0.0);
}

}  // namespace

PrincipalStretches principal_stretches(const Eigen::Matrix3d& g) {
  PrincipalStretches result;
  if (!g.allFinite()) {
    result.u = result.v = Eigen::Matrix3d::Identity();
    result.sigma.setConstant(std::numeric_limits<double>::quiet_NaN());
    return result;
  }
  // G = R S with R the nearest rotation: S is symmetric, and its eigenvalues are the signed
  // stretches.
  const Eigen::Matrix3d r = nearest_rotation(g).toRotationMatrix();
  const Eigen::Matrix3d s = r.transpose() * g;
  const SymmetricEigen3 eigen = symmetric_eigen3(0.5 * (s + s.transpose()));
  result.sigma = eigen.values.reverse();
  result.v = eigen.vectors.rowwise().reverse();
  if (result.v.determinant() < 0.0) result.v.col(2) = -result.v.col(2);
  result.u = r * result.v;
  return result;
}

Eigen::Vector3d twist_slopes(const Eigen::Vector3d& sigma, const Eigen::Vector3d& p) {
  Eigen::Vector3d twist;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double above = p[i] + p[j];
    twist[k] = above / std::max(sigma[i] + sigma[j], above / kLargestTwist);
  }
  return twist;
}

Matrix9d distance_tangent(const PrincipalStretches& g, const StretchSlope& slope,
                          Definiteness definiteness) {
  Matrix9d tangent = Matrix9d::Zero();
  const Eigen::Matrix3d stretch =
      make_definite(Eigen::Matrix3d::Identity() - slope.stretch, definiteness);
  Eigen::Matrix<double, 9, 3> stretches;
  for (int k = 0; k < 3; ++k) {
    stretches.col(k) = flat(g.u.col(k) * g.v.col(k).transpose());
  }
  tangent = stretches * stretch * stretches.transpose();
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Eigen::Matrix3d ij = g.u.col(i) * g.v.col(j).transpose();
    const Eigen::Matrix3d ji = g.u.col(j) * g.v.col(i).transpose();
    const Vector9d flip = flat(ij + ji), twist = flat(ij - ji);
    // Both have the squared length 2.
    tangent += 0.5 * make_definite(1.0 - slope.flip[k], definiteness) * flip * flip.transpose();
    tangent += 0.5 * make_definite(1.0 - slope.twist[k], definiteness) * twist * twist.transpose();
  }
  return tangent;
}

}  // namespace pliant
