#include "pliant/elements/clusters/cluster_rotation.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/elements/solids/principal_stretches.h"
#include "pliant/math/rotation_eigen.h"

namespace pliant {
namespace {
// σᵢ + σⱼ below this share of the whole counts as zero.
constexpr double kLeastShare = 1e-12;
// The product of the three sums, below this share of the whole's cube: the rotation may be free.
constexpr double kFree = 1e-13;
}  // namespace

bool is_determined(const Eigen::Matrix3d& rotation, const Eigen::Matrix3d& moment) {
  // tr(S) I - S, S = RᵀA, has the eigenvalues σᵢ + σⱼ.
  const Eigen::Matrix3d stretch = rotation.transpose() * moment;
  const double trace = stretch.trace();
  const double sums = (trace * Eigen::Matrix3d::Identity() - stretch).determinant();
  return sums > kFree * trace * trace * trace;
}

Eigen::Matrix3d cluster_rotation(const Eigen::Matrix3d& moment, const Eigen::Matrix3d& previous) {
  const Eigen::Matrix3d rotation = nearest_rotation(moment).toRotationMatrix();
  if (is_determined(rotation, moment)) return rotation;
  return nearest_rotation(moment, Eigen::Quaterniond(previous)).toRotationMatrix();
}

ClusterTwists::ClusterTwists(const Eigen::Matrix3d& moment, const Eigen::Matrix3d& spread,
                             Definiteness definiteness) {
  const PrincipalStretches a = principal_stretches(moment);
  const double least = std::max(kLeastShare * std::max(spread.trace(), a.sigma[0]),
                                std::numeric_limits<double>::min());
  Eigen::Vector3d roots;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    twists_[k] = std::sqrt(0.5) *
                 (a.u.col(i) * a.v.col(j).transpose() - a.u.col(j) * a.v.col(i).transpose());
    roots[k] = std::sqrt(2.0 / std::max(a.sigma[i] + a.sigma[j], least));
  }
  Eigen::Matrix3d share = Eigen::Matrix3d::Identity();
  if (definiteness == Definiteness::kProjected) {
    // In coordinates in which the mass matrix is the identity the weights' part is Z Zᵀ with
    // ZᵀZ = diag(roots) Γ diag(roots), Γₖₗ = tr(Tₖ Σ m q qᵀ Tₗᵀ): its eigenvalues must not
    // exceed 1.
    Eigen::Matrix3d gram;
    for (int k = 0; k < 3; ++k) {
      for (int l = 0; l < 3; ++l) {
        gram(k, l) = roots[k] * roots[l] * (twists_[k] * spread).cwiseProduct(twists_[l]).sum();
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(gram);
    const Eigen::Vector3d cut = eigen.eigenvalues().cwiseMax(1.0).cwiseInverse();
    share = eigen.eigenvectors() * cut.cwiseSqrt().asDiagonal();
  }
  roots_ = roots.asDiagonal() * share;
}

}  // namespace pliant
