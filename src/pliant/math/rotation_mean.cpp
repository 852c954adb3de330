#include "pliant/math/rotation_mean.h"

#include <cmath>

namespace pliant {
namespace {

/// 2 log q, the shorter way round.
Eigen::Vector3d rotation_vector(Eigen::Quaterniond q) {
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (!(sine > 0.0)) return Eigen::Vector3d::Zero();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

Eigen::Quaterniond exponential(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (!(angle > 0.0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle));
}

}  // namespace

Eigen::Quaterniond linear_rotation_mean(const Eigen::Ref<const Eigen::Matrix4Xd>& rotations,
                                        const Eigen::Ref<const Eigen::VectorXd>& weights) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (Eigen::Index k = 0; k < rotations.cols(); ++k) {
    const double sign = rotations.col(k).dot(rotations.col(0)) < 0.0 ? -1.0 : 1.0;
    sum += sign * weights[k] * rotations.col(k);
  }
  // Half turns that cancel leave no direction: the first then.
  if (!(sum.norm() > 1e-12 * weights.sum())) sum = rotations.col(0);
  Eigen::Quaterniond mean;
  mean.coeffs() = sum.normalized();
  return mean;
}

Eigen::Quaterniond exponential_rotation_mean(const Eigen::Ref<const Eigen::Matrix4Xd>& rotations,
                                             const Eigen::Ref<const Eigen::VectorXd>& weights,
                                             int repeats) {
  Eigen::Quaterniond mean = linear_rotation_mean(rotations, weights);
  for (int repeat = 0; repeat < repeats; ++repeat) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < rotations.cols(); ++k) {
      Eigen::Quaterniond q;
      q.coeffs() = rotations.col(k);
      sum += weights[k] * rotation_vector(mean.conjugate() * q);
    }
    mean = (mean * exponential(sum / weights.sum())).normalized();
  }
  return mean;
}

}  // namespace pliant
