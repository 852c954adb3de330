#include "pliant/models/viscoelastic/blended_clusters.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/math/joined.h"
#include "pliant/math/rotation_eigen.h"
#include "pliant/models/viscoelastic/cluster_plan.h"

namespace pliant {
namespace {

// A cluster's spread counts as at least that of so many spacings: two particles that happen to lie
// together do not make a needle of infinite stiffness.
constexpr double kLeastExtent = 0.5;
// In spacings: particles of one part that lie nearer when it is made are side by side.
constexpr double kBeside = 2.0;
// Of solid ellipsoids that together fill the body: a ball of the volume V has the radius 0.62 V^⅓.
constexpr double kBallRadius = 0.6204;

std::size_t at(int k) { return static_cast<std::size_t>(k); }

}  // namespace

void BlendedClusters::add_part(const Positions& x, const Eigen::VectorXd& masses,
                               const Eigen::VectorXd& volumes, const SolidMaterial& material) {
  const int count = static_cast<int>(x.cols());
  const double spacing = count > 0 ? std::cbrt(volumes.mean()) : 1.0;
  parts_.push_back({static_cast<int>(masses_.size()), count, spacing, material});
  masses_ = above(masses_, masses);
  volumes_ = above(volumes_, volumes);
  weights_ = above(weights_, Eigen::VectorXd::Zero(count));
  made_ = beside(made_, x);
  lasting_ = above(lasting_, Eigen::VectorXd::Ones(count));
}

int BlendedClusters::part_of(int particle) const {
  int part = 0;
  while (particle >= parts_[at(part)].first + parts_[at(part)].count) ++part;
  return part;
}

Eigen::Quaterniond BlendedClusters::orientation(int particle) const {
  const OrientedClusterSet* known = oriented();
  // Of parts that came after the set was made nothing has turned yet.
  const bool is_known = known != nullptr && particle < known->particles();
  return is_known ? known->orientation(particle) : Eigen::Quaterniond::Identity();
}

void BlendedClusters::place(const Eigen::Isometry3d& world_from_body) {
  made_ = (world_from_body.linear() * made_).colwise() + world_from_body.translation();
  if (!oriented_ || !inner_) return;
  auto& turned = static_cast<OrientedClusterSet&>(*inner_);
  const Eigen::Quaterniond turn(world_from_body.linear());
  for (int i = 0; i < turned.particles(); ++i) {
    turned.set_orientation(i, turn * turned.orientation(i), turn * turned.angular_velocity(i));
  }
}

bool BlendedClusters::set_time_step(double dt) {
  if (dt == dt_) return false;
  dt_ = dt;
  const bool any = std::any_of(parts_.begin(), parts_.end(),
                               [](const Part& part) { return part.material.alpha > 0.0; });
  if (!any || !inner_) return false;
  spread_stiffness();
  for (int c = 0; c < clusters(); ++c) inner_->set_stiffness(c, clusters_[at(c)].stiffness);
  return true;
}

bool BlendedClusters::follow(const Eigen::VectorXd& beta, const Positions& x) {
  const Eigen::VectorXd wanted = weights_of(beta);
  lasting_ = (wanted.array() > 0.0).select(lasting_, 0.0);
  if (wanted == weights_) return false;
  std::vector<int> frozen;
  for (int i = 0; i < weights_.size(); ++i) {
    if (weights_[i] == 0.0 && wanted[i] > 0.0) frozen.push_back(i);
  }
  const Eigen::VectorXd before = energies(x);
  weights_ = wanted;
  if (!frozen.empty()) freeze(x, frozen);
  if (inner_) inner_->set_weights(weights_, x);
  take_rest();
  note_loss(before, x);
  return true;
}

Eigen::VectorXd BlendedClusters::energies(const Positions& x) const {
  if (!keeps_losses_ || !inner_) return {};
  return inner_->particle_energies(x);
}

void BlendedClusters::note_loss(const Eigen::VectorXd& before, const Positions& x) {
  if (before.size() == 0) return;
  const Eigen::VectorXd after = inner_ ? energies(x) : Eigen::VectorXd::Zero(before.size());
  const double lost = before.sum() - after.sum();
  // Where what stays fits anew, one particle may give energy to another: those that lost share it.
  const Eigen::VectorXd less = (before - after).cwiseMax(0.0);
  if (!(lost > 0.0) || !(less.sum() > 0.0)) return;
  if (losses_.size() == 0) losses_.setZero(before.size());
  losses_ += lost / less.sum() * less;
}

bool BlendedClusters::are_bound(int i, int j) const {
  const int part = part_of(i);
  if (part != part_of(j)) return false;
  const double near = kBeside * parts_[at(part)].spacing;
  const bool were_beside = (made_.col(i) - made_.col(j)).squaredNorm() < near * near;
  if (were_beside && lasting_[i] > 0.0 && lasting_[j] > 0.0) return true;
  if (holders_.empty()) return false;
  // A pair in contact is rare, so that this may take its time.
  return std::any_of(holders_[at(i)].begin(), holders_[at(i)].end(), [&](int c) {
    return std::binary_search(holders_[at(j)].begin(), holders_[at(j)].end(), c);
  });
}

void BlendedClusters::keep_present() {
  // Without those that melted since.
  std::vector<Cluster> kept;
  std::vector<int> parts;
  for (int c = 0; c < clusters(); ++c) {
    const ClusterShapes::Shape& shape = inner_->shapes().shape(c);
    Cluster cluster{{}, shape.stiffness, {}};
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& member = inner_->shapes().member(k);
      if (member.weight == 0.0) continue;
      cluster.particles.push_back(member.particle);
      cluster.rest.push_back(member.rest);
    }
    if (cluster.particles.empty()) continue;
    kept.push_back(std::move(cluster));
    parts.push_back(cluster_parts_[at(c)]);
  }
  clusters_ = std::move(kept);
  cluster_parts_ = std::move(parts);
}

void BlendedClusters::freeze(const Positions& x, const std::vector<int>& frozen) {
  keep_present();
  for (const Part& part : parts_) {
    std::vector<int> own;
    for (int i : frozen) {
      if (i >= part.first && i < part.first + part.count) own.push_back(i);
    }
    if (!own.empty()) add_clusters(part, x, own);
  }
  make_set(x);
}

void BlendedClusters::add_clusters(const Part& part, const Positions& x,
                                   const std::vector<int>& frozen) {
  std::vector<int> solid;
  for (int i = part.first; i < part.first + part.count; ++i) {
    if (weights_[i] > 0.0) solid.push_back(i);
  }
  const SolidMaterial& material = part.material;
  std::vector<std::vector<int>> groups;
  if (material.rigid && frozen.size() == solid.size()) {
    groups.push_back(solid);
  } else {
    // Never further apart than the radius: every particle is in some cluster.
    const double separation =
        separation_for(x, frozen, material.cluster_fraction, material.cluster_radius);
    groups = groups_about(x, spaced_subset(x, frozen, separation), solid, material.cluster_radius);
  }
  for (std::vector<int>& group : groups) {
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    if (oriented() != nullptr) {
      // In the frame that its particles, on average, have turned from.
      Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
      for (int i : group) sum += orientation(i).toRotationMatrix();
      turn = nearest_rotation(sum).toRotationMatrix();
    }
    Cluster cluster{std::move(group), 0.0, {}};
    for (int i : cluster.particles) {
      cluster.rest.push_back(turn.transpose() * (x.col(i) - x.col(cluster.particles.front())));
    }
    clusters_.push_back(std::move(cluster));
    cluster_parts_.push_back(static_cast<int>(&part - parts_.data()));
  }
}

void BlendedClusters::spread_stiffness() {
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(weights_.size());
  for (const Cluster& cluster : clusters_) {
    for (int i : cluster.particles) counts[i] += 1.0;
  }
  for (std::size_t c = 0; c < clusters_.size(); ++c) {
    Cluster& cluster = clusters_[c];
    const Part& part = parts_[at(cluster_parts_[c])];
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double share = 0.0, spread = 0.0, mass = 0.0, count = 0.0;
    for (std::size_t k = 0; k < cluster.particles.size(); ++k) {
      const int i = cluster.particles[k];
      middle += masses_[i] * cluster.rest[k];
      mass += masses_[i];
      share += volumes_[i] / counts[i];
      count += counts[i];
    }
    middle /= mass;
    for (std::size_t k = 0; k < cluster.particles.size(); ++k) {
      spread += masses_[cluster.particles[k]] * (cluster.rest[k] - middle).squaredNorm();
    }
    const double least = kLeastExtent * part.spacing;
    cluster.stiffness = 3.0 * part.material.young * share / std::max(spread, mass * least * least);
    if (part.material.alpha > 0.0) {
      // v += alpha (g − x)/h, with all the clusters of a particle together: h² k / (1 + h² k).
      const double alpha = part.material.alpha;
      const double mean = count / static_cast<double>(cluster.particles.size());
      cluster.stiffness = dt_ > 0.0 ? alpha / (1.0 - alpha) / (dt_ * dt_ * mean) : 0.0;
    }
  }
}

void BlendedClusters::make_set(const Positions& x) {
  spread_stiffness();
  holders_.assign(at(static_cast<int>(masses_.size())), {});
  for (std::size_t c = 0; c < clusters_.size(); ++c) {
    for (int i : clusters_[c].particles) holders_[at(i)].push_back(static_cast<int>(c));
  }
  if (clusters_.empty()) {
    inner_.reset();
    return;
  }
  if (!oriented_) {
    inner_ = std::make_unique<ClusterSet>(x, masses_, clusters_);
    return;
  }
  std::vector<Eigen::Matrix3d> moments;
  for (int i = 0; i < masses_.size(); ++i) {
    moments.push_back(ellipsoid_moment(
        masses_[i], Eigen::Vector3d::Constant(kBallRadius * std::cbrt(volumes_[i]))));
  }
  auto made = std::make_unique<OrientedClusterSet>(x, masses_, moments, clusters_);
  made->set_blend(blend_);
  const auto* before = static_cast<const OrientedClusterSet*>(inner_.get());
  // Parts that joined since then have not turned yet.
  for (int i = 0; before != nullptr && i < before->particles(); ++i) {
    made->set_orientation(i, before->orientation(i), before->angular_velocity(i));
  }
  inner_ = std::move(made);
}

void BlendedClusters::creep(const Positions& x, double yield, double share) {
  if (!inner_) return;
  const Eigen::VectorXd before = energies(x);
  inner_->creep(x, yield, share);
  take_rest();
  note_loss(before, x);
}

void BlendedClusters::advance(const Positions& x, double dt) {
  if (oriented_ && inner_) static_cast<OrientedClusterSet&>(*inner_).advance_orientations(x, dt);
}

Eigen::VectorXd BlendedClusters::counts() const {
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(weights_.size());
  for (int c = 0; c < clusters(); ++c) {
    const ClusterShapes::Shape& shape = inner_->shapes().shape(c);
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& member = inner_->shapes().member(k);
      if (member.weight > 0.0) counts[member.particle] += 1.0;
    }
  }
  return counts;
}

void BlendedClusters::add_forces(const Positions& x, Forces& f) const {
  if (inner_) inner_->add_forces(x, f);
}

void BlendedClusters::add_to_system(SystemMatrix& a) const {
  if (inner_) inner_->add_to_system(a);
}

void BlendedClusters::add_stiffness(const Positions& x, Definiteness definiteness,
                                    StiffnessMatrix& k) const {
  if (inner_) inner_->add_stiffness(x, definiteness, k);
}

void BlendedClusters::reset() {
  losses_.resize(0);
  if (inner_) inner_->reset();
}

void BlendedClusters::reset_multipliers() {
  if (inner_) inner_->reset_multipliers();
}

void BlendedClusters::relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) {
  if (inner_) inner_->relax(inverse_mass, dt, x);
}

void BlendedClusters::save(StateArchive& numbers) const {
  numbers.write(dt_);
  numbers.write_all(weights_);
  numbers.write_all(lasting_);
  if (keeps_losses_) {
    numbers.write(losses_.size() > 0 ? 1.0 : 0.0);
    numbers.write_all(losses_);
  }
  numbers.write(clusters());
  for (int c = 0; c < clusters(); ++c) {
    numbers.write(cluster_parts_[at(c)]);
    numbers.write(static_cast<double>(clusters_[at(c)].particles.size()));
    for (int i : clusters_[at(c)].particles) numbers.write(i);
  }
  if (inner_) inner_->save(numbers);
}

void BlendedClusters::load(StateArchive& numbers) {
  dt_ = numbers.read();
  numbers.read_all(weights_);
  numbers.read_all(lasting_);
  if (keeps_losses_) {
    losses_.resize(numbers.read_whole(0, 1) * masses_.size());
    numbers.read_all(losses_);
  }
  clusters_.clear();
  cluster_parts_.clear();
  for (std::size_t left = numbers.read_count(); left > 0; --left) {
    cluster_parts_.push_back(numbers.read_index(static_cast<std::int64_t>(parts_.size())));
    Cluster cluster;
    cluster.particles.resize(numbers.read_count());
    for (int& i : cluster.particles) i = numbers.read_index(masses_.size());
    cluster.rest.assign(cluster.particles.size(), Eigen::Vector3d::Zero());
    clusters_.push_back(std::move(cluster));
  }
  make_set(Positions::Zero(3, masses_.size()));
  if (inner_) inner_->load(numbers);
  take_rest();
}

void BlendedClusters::take_rest() {
  for (int c = 0; c < clusters(); ++c) {
    const ClusterShapes::Shape& shape = inner_->shapes().shape(c);
    clusters_[at(c)].stiffness = shape.stiffness;
    for (int k = shape.begin; k < shape.end; ++k) {
      clusters_[at(c)].rest[at(k - shape.begin)] = inner_->shapes().member(k).rest;
    }
  }
}

}  // namespace pliant
