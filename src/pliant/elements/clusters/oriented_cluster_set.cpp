#include "pliant/elements/clusters/oriented_cluster_set.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>

#include "pliant/core/parallel/parallel.h"
#include "pliant/elements/clusters/cluster_rotation.h"
#include "pliant/math/error.h"
#include "pliant/math/rotation_mean.h"

namespace pliant {
namespace {

constexpr int kGrain = 128;

void check(const std::vector<Eigen::Matrix3d>& moments, Eigen::Index particles) {
  if (static_cast<Eigen::Index>(moments.size()) != particles) {
    throw InputError(fmt::format("oriented_cluster: {} moments for {} particles; give one each",
                                 moments.size(), particles));
  }
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const Eigen::Matrix3d& d = moments[i];
    const bool symmetric = d.allFinite() && (d - d.transpose()).norm() <= 1e-12 * d.norm();
    if (symmetric && Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(d).eigenvalues()[0] > 0.0) {
      continue;
    }
    throw InputError(fmt::format(
        "oriented_cluster: the moment of particle {} is not symmetric and positive definite; give "
        "ellipsoid_moment() a positive mass and positive semi-axes",
        i));
  }
}

/// The rotation by the vector `turn` [rad].
Eigen::Matrix3d rotation_by(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (!(angle > 0.0)) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

/// The shorter way round.
Eigen::Vector3d turn_of(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(Eigen::Quaterniond(rotation).normalized());
  return turn.angle() * turn.axis();
}

}  // namespace

Eigen::Matrix3d ellipsoid_moment(double mass, const Eigen::Vector3d& semi_axes,
                                 const Eigen::Matrix3d& axes) {
  return mass / 5.0 * axes * semi_axes.cwiseAbs2().asDiagonal() * axes.transpose();
}

OrientedClusterSet::OrientedClusterSet(const Positions& rest, const Eigen::VectorXd& masses,
                                       const std::vector<Eigen::Matrix3d>& moments,
                                       const std::vector<Cluster>& clusters)
    : ClusterSet("oriented_cluster", rest, masses, clusters) {
  check(moments, rest.cols());
  spins_ = moments;
  OrientedClusterSet::reset();
}

void OrientedClusterSet::reset() {
  ClusterSet::reset();
  orientations_.assign(spins_.size(), Eigen::Matrix3d::Identity());
  orientations_changed();
  velocities_.assign(spins_.size(), Eigen::Vector3d::Zero());
}

void OrientedClusterSet::save(StateArchive& numbers) const {
  ClusterSet::save(numbers);
  for (const Eigen::Matrix3d& orientation : orientations_) numbers.write_all(orientation);
  for (const Eigen::Vector3d& velocity : velocities_) numbers.write_all(velocity);
}

void OrientedClusterSet::load(StateArchive& numbers) {
  ClusterSet::load(numbers);
  for (Eigen::Matrix3d& orientation : orientations_) numbers.read_all(orientation);
  for (Eigen::Vector3d& velocity : velocities_) numbers.read_all(velocity);
  orientations_changed();
}

double OrientedClusterSet::pull(const Incidence& incidence, double dt) const {
  return dt * dt * shapes().member(incidence.member).weight *
         shapes().shape(incidence.cluster).stiffness;
}

Eigen::Matrix3d OrientedClusterSet::moments_turn(int particle, const Eigen::Matrix3d& predicted,
                                                 double dt) const {
  // Times h²; the minimum is the rotation nearest to this sum times D.
  Eigen::Matrix3d sum = predicted;
  for (int n = incidence_begin(particle); n < incidence_begin(particle + 1); ++n) {
    sum += pull(incidence(n), dt) * rotation_of(motion(incidence(n).cluster));
  }
  return cluster_rotation(sum * spins_[static_cast<std::size_t>(particle)], predicted);
}

Eigen::Matrix3d OrientedClusterSet::mean_turn(int particle, const Eigen::Matrix3d& predicted,
                                              double dt, Eigen::Matrix4Xd& turns,
                                              Eigen::VectorXd& weights) const {
  const int first = incidence_begin(particle);
  const int count = incidence_begin(particle + 1) - first + 1;
  if (count > turns.cols()) {
    turns.resize(4, 2 * count);
    weights.resize(2 * count);
  }
  turns.col(0) = Eigen::Quaterniond(predicted).coeffs();
  weights[0] = 1.0;
  for (int k = 1; k < count; ++k) {
    const Incidence& of = incidence(first + k - 1);
    turns.col(k) = Eigen::Quaterniond(rotation_of(motion(of.cluster))).coeffs();
    weights[k] = pull(of, dt);
  }
  const Eigen::Quaterniond mean =
      blend_ == TurnBlend::kLinear
          ? linear_rotation_mean(turns.leftCols(count), weights.head(count))
          : exponential_rotation_mean(turns.leftCols(count), weights.head(count));
  return mean.toRotationMatrix();
}

void OrientedClusterSet::advance_orientations(const Positions& x, double dt) {
  fit_all(x);
  parallel_for(0, particles(), kGrain, [&](int begin, int end) {
    Eigen::Matrix4Xd turns;
    Eigen::VectorXd weights;
    for (int i = begin; i < end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Eigen::Matrix3d predicted = rotation_by(dt * velocities_[at]) * orientations_[at];
      const Eigen::Matrix3d turned = blend_ == TurnBlend::kMoments
                                         ? moments_turn(i, predicted, dt)
                                         : mean_turn(i, predicted, dt, turns, weights);
      velocities_[at] = turn_of(turned * orientations_[at].transpose()) / dt;
      orientations_[at] = turned;
    }
  });
  orientations_changed();
}

Eigen::Quaterniond OrientedClusterSet::orientation(int particle) const {
  return Eigen::Quaterniond(orientations_[static_cast<std::size_t>(particle)]);
}

void OrientedClusterSet::set_orientation(int particle, const Eigen::Quaterniond& orientation,
                                         const Eigen::Vector3d& angular_velocity) {
  orientations_[static_cast<std::size_t>(particle)] = orientation.normalized().toRotationMatrix();
  velocities_[static_cast<std::size_t>(particle)] = angular_velocity;
  orientations_changed();
}

}  // namespace pliant
