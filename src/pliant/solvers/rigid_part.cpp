#include "pliant/solvers/rigid_part.h"

#include <Eigen/Eigenvalues>

namespace pliant {
namespace {
// Of the largest moment of inertia; a smaller one is none, as about a line's own axis.
constexpr double kNoInertia = 1e-12;
}  // namespace

void RigidPart::prepare(const Positions& y, const Eigen::VectorXd& masses) {
  masses_ = masses;
  mass_ = masses.sum();
  const Eigen::Vector3d origin = y.cols() > 0 ? Eigen::Vector3d(y.col(0)) : Eigen::Vector3d::Zero();
  arms_ = y.colwise() - origin;
  const Eigen::Vector3d center = arms_ * masses / mass_;
  arms_.colwise() -= center;
  // Σ m (|q|² I − q qᵀ)
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < arms_.cols(); ++i) {
    const Eigen::Vector3d q = arms_.col(i);
    inertia += masses[i] * (q.squaredNorm() * Eigen::Matrix3d::Identity() - q * q.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(inertia);
  Eigen::Vector3d inverse = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const double value = eigen.eigenvalues()[k];
    if (value > kNoInertia * eigen.eigenvalues()[2]) inverse[k] = 1.0 / value;
  }
  inverse_inertia_ = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

void RigidPart::remove(Positions& displacements) const {
  if (displacements.cols() == 0) return;
  const Eigen::Vector3d shift = displacements * masses_ / mass_;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < arms_.cols(); ++i) {
    moment += masses_[i] * arms_.col(i).cross(displacements.col(i));
  }
  const Eigen::Vector3d turn = inverse_inertia_ * moment;
  for (Eigen::Index i = 0; i < arms_.cols(); ++i) {
    displacements.col(i) -= shift + turn.cross(arms_.col(i));
  }
}

}  // namespace pliant
