#include "pliant/elements/clusters/cluster_set.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "pliant/core/parallel/parallel.h"
#include "pliant/core/parallel/parallel_reduce.h"
#include "pliant/elements/clusters/cluster_rotation.h"
#include "pliant/math/rotation_batch.h"
#include "pliant/math/rotation_eigen.h"

namespace pliant {
namespace {
constexpr int kClusterGrain = 32;
constexpr int kParticleGrain = 128;

PackedClusters::Motion motion_of(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& center) {
  PackedClusters::Motion motion = PackedClusters::Motion::Zero();
  motion.topLeftCorner<3, 3>() = rotation;
  motion.topRightCorner<3, 1>() = center;
  return motion;
}

}  // namespace

ClusterSet::ClusterSet(const Positions& rest, const Eigen::VectorXd& masses,
                       const std::vector<Cluster>& clusters)
    : ClusterSet("cluster", rest, masses, clusters) {}

ClusterSet::ClusterSet(std::string name, const Positions& rest, const Eigen::VectorXd& masses,
                       const std::vector<Cluster>& clusters)
    : name_(std::move(name)), shapes_(name_, rest, masses, clusters) {
  fits_.assign(clusters.size(), Motion::Identity());
  multipliers_.setZero(3, shapes_.members());
  incidence_begins_.assign(static_cast<std::size_t>(rest.cols()) + 1, 0);
  for (int k = 0; k < shapes_.members(); ++k) {
    ++incidence_begins_[static_cast<std::size_t>(shapes_.member(k).particle) + 1];
  }
  for (std::size_t i = 1; i < incidence_begins_.size(); ++i) {
    incidence_begins_[i] += incidence_begins_[i - 1];
  }
  incidences_.resize(static_cast<std::size_t>(shapes_.members()));
  std::vector<int> next = incidence_begins_;
  for (int c = 0; c < size(); ++c) {
    for (int k = shapes_.shape(c).begin; k < shapes_.shape(c).end; ++k) {
      int& place = next[static_cast<std::size_t>(shapes_.member(k).particle)];
      incidences_[static_cast<std::size_t>(place++)] = {c, k};
    }
  }
}

Eigen::Matrix3d ClusterSet::turned_spin(int cluster) const {
  const ClusterShapes::Shape& shape = shapes_.shape(cluster);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int k = shape.begin; k < shape.end; ++k) {
    const auto i = static_cast<std::size_t>(shapes_.member(k).particle);
    sum += shapes_.member(k).weight * orientations_[i] * spins_[i];
  }
  return sum;
}

Eigen::Matrix3d ClusterSet::moment(int cluster, const Positions& x,
                                   const Eigen::Vector3d& center) const {
  const Eigen::Matrix3d moment = shapes_.moment(shapes_.shape(cluster), x, center);
  return spins_.empty() ? moment : Eigen::Matrix3d(moment + turned_spin(cluster));
}

Eigen::Matrix3d ClusterSet::rotation(int cluster, const Eigen::Matrix3d& moment) const {
  // Bits that depend on history only where the answer does.
  const bool always_free = shapes_.shape(cluster).straight && spins_.empty();
  return always_free
             ? nearest_rotation(moment).toRotationMatrix()
             : cluster_rotation(moment, rotation_of(fits_[static_cast<std::size_t>(cluster)]));
}

ClusterSet::Motion ClusterSet::fit(int cluster, const Positions& x) const {
  const Eigen::Vector3d center = shapes_.center(shapes_.shape(cluster), x);
  return motion_of(rotation(cluster, moment(cluster, x, center)), center);
}

void ClusterSet::fit_range(int begin, int end, std::vector<Motion>& fits) const {
  Eigen::Vector3d centers[kClusterGrain];
  Eigen::Matrix3d moments[kClusterGrain];
  Matrix3<double> plain[kClusterGrain] = {};
  Quaternion<double> nearest[kClusterGrain];
  packed_.gather(begin, end, centers, moments);
  for (int c = begin; c < end; ++c) {
    const int k = c - begin;
    if (!spins_.empty()) moments[k] += turned_spins_[static_cast<std::size_t>(c)];
    plain[k] = to_plain(moments[k]);
  }
  nearest_rotations_cold(plain, nearest, end - begin);
  for (int c = begin; c < end; ++c) {
    const int k = c - begin;
    const Eigen::Matrix3d found = to_eigen(nearest[k]).toRotationMatrix();
    fits[static_cast<std::size_t>(c)] =
        motion_of(is_determined(found, moments[k]) ? found : rotation(c, moments[k]), centers[k]);
  }
}

void ClusterSet::sum_turned_spins() const {
  turned_spins_.resize(fits_.size());
  parallel_for(0, size(), kClusterGrain, [&](int begin, int end) {
    for (int c = begin; c < end; ++c) turned_spins_[static_cast<std::size_t>(c)] = turned_spin(c);
  });
}

const std::vector<Eigen::Matrix3d>& ClusterSet::turned_spins() const {
  if (turned_spins_.empty() && !spins_.empty()) sum_turned_spins();
  return turned_spins_;
}

void ClusterSet::fit_all(const Positions& x, std::vector<Motion>& fits) const {
  if (!packed_.is_built()) packed_.build(shapes_, particles());
  turned_spins();
  packed_.set_positions(x);
  fits.resize(fits_.size());
  const int blocks = (size() + kClusterGrain - 1) / kClusterGrain;
  parallel_for(0, blocks, 1, [&](int first, int last) {
    for (int b = first; b < last; ++b) {
      fit_range(b * kClusterGrain, std::min(size(), (b + 1) * kClusterGrain), fits);
    }
  });
}

const std::vector<ClusterSet::Motion>& ClusterSet::fits(const Positions& x) const {
  fit_all(x, fits_);
  return fits_;
}

long ClusterSet::new_version() {
  static std::atomic<long> last{0};
  return ++last;
}

void ClusterSet::changed() {
  packed_.clear();
  version_ = new_version();
}

void ClusterSet::set_stiffness(int cluster, double stiffness) {
  shapes_.set_stiffness(cluster, stiffness);
  changed();
}

void ClusterSet::set_weights(const Eigen::VectorXd& weights, const Positions& x) {
  for (int c = 0; c < size(); ++c) {
    const ClusterShapes::Shape& shape = shapes_.shape(c);
    const auto grows = [&](const ClusterShapes::Member& m) {
      return weights[m.particle] > m.weight;
    };
    bool changes = false, any_grows = false;
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& m = shapes_.member(k);
      changes |= weights[m.particle] != m.weight;
      any_grows |= grows(m);
    }
    if (!changes) continue;
    const Motion now = any_grows ? fit(c, x) : Motion(Motion::Identity());
    const Eigen::Matrix3d back = rotation_of(now).transpose();
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& m = shapes_.member(k);
      const double weight = weights[m.particle];
      Eigen::Vector3d rest = m.rest;
      if (grows(m)) {
        const Eigen::Vector3d here = back * (x.col(m.particle) - now.topRightCorner<3, 1>());
        rest = (m.weight * m.rest + (weight - m.weight) * here) / weight;
      }
      shapes_.set_member(k, weight, rest);
    }
    shape_changed(c);
  }
}

void ClusterSet::creep(const Positions& x, double yield, double share) {
  for (int c = 0; c < size(); ++c) {
    const ClusterShapes::Shape& shape = shapes_.shape(c);
    if (shape.mass == 0.0) continue;
    const Motion now = fit(c, x);
    const Eigen::Matrix3d back = rotation_of(now).transpose();
    const auto here = [&](const ClusterShapes::Member& m) -> Eigen::Vector3d {
      return back * (x.col(m.particle) - now.topRightCorner<3, 1>());
    };
    double apart = 0.0, size = 0.0;
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& m = shapes_.member(k);
      apart += m.mass * (here(m) - m.rest).squaredNorm();
      size += m.mass * m.rest.squaredNorm();
    }
    const double strain = size > 0.0 ? std::sqrt(apart / size) : 0.0;
    if (!(strain > yield)) continue;
    const double part = share * (1.0 - yield / strain);
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& m = shapes_.member(k);
      shapes_.set_member(k, m.weight, m.rest + part * (here(m) - m.rest));
    }
    shape_changed(c);
  }
}

void ClusterSet::shape_changed(int cluster) {
  shapes_.rebalance(cluster);
  changed();
  turned_spins_.clear();
}

template <class Add>
void ClusterSet::for_each_square(int cluster, const Positions& x, const Add& add) const {
  const ClusterShapes::Shape& shape = shapes_.shape(cluster);
  if (shape.mass == 0.0) return;
  const Motion& best = energy_fits_[static_cast<std::size_t>(cluster)];
  const Eigen::Matrix3d rotation = rotation_of(best);
  const Eigen::Vector3d center = best.topRightCorner<3, 1>();
  for (int k = shape.begin; k < shape.end; ++k) {
    const ClusterShapes::Member& m = shapes_.member(k);
    add(m.particle, m.mass * (x.col(m.particle) - center - rotation * m.rest).squaredNorm());
    if (spins_.empty()) continue;
    // ∫ρ |(O - R) r|² = tr((O - R) D (O - R)ᵀ)
    const auto i = static_cast<std::size_t>(m.particle);
    const Eigen::Matrix3d turn = orientations_[i] - rotation;
    add(m.particle, m.weight * (turn * spins_[i]).cwiseProduct(turn).sum());
  }
}

Eigen::VectorXd ClusterSet::particle_energies(const Positions& x) const {
  fit_all(x, energy_fits_);
  Eigen::VectorXd energies = Eigen::VectorXd::Zero(particles());
  for (int c = 0; c < size(); ++c) {
    const double half = 0.5 * shapes_.shape(c).stiffness;
    for_each_square(c, x, [&](int i, double square) { energies[i] += half * square; });
  }
  return energies;
}

double ClusterSet::energy(const Positions& x) const {
  fit_all(x, energy_fits_);
  return parallel_sum(0, size(), kClusterGrain, [&](int c) {
    double sum = 0.0;
    for_each_square(c, x, [&](int, double square) { sum += square; });
    return 0.5 * shapes_.shape(c).stiffness * sum;
  });
}

void ClusterSet::add_forces(const Positions& x, Forces& f) const {
  fit_all(x, fits_);
  // Each particle gathers from its clusters in their order.
  parallel_for(0, particles(), kParticleGrain,
               [&](int begin, int end) { packed_.add_forces(begin, end, fits_, f); });
}

double ClusterSet::work() const {
  // Measured: a member costs as much as this many entries of a spring or a tetrahedron.
  constexpr double kMemberWork = 4.0;
  double members = 0.0;
  for (int c = 0; c < size(); ++c) members += shapes_.shape(c).end - shapes_.shape(c).begin;
  return kMemberWork * members;
}

void ClusterSet::add_to_system(SystemMatrix& a) const {
  SharedEntries shared;
  for (int c = 0; c < size(); ++c) {
    const ClusterShapes::Shape& shape = shapes_.shape(c);
    if (shape.mass == 0.0) continue;
    shared.members.clear();
    for (int k = shape.begin; k < shape.end; ++k) {
      shared.members.push_back({shapes_.member(k).particle, shapes_.member(k).mass});
    }
    shared.mass = shape.mass;
    shared.stiffness = shape.stiffness;
    a.add_shared(shared);
  }
}

void ClusterSet::add_stiffness(const Positions& x, Definiteness definiteness,
                               StiffnessMatrix& k) const {
  SharedStiffness shared;
  for (int c = 0; c < size(); ++c) {
    if (shapes_.shape(c).mass == 0.0) continue;
    find_stiffness(c, x, definiteness, shared);
    // One particle is where its goal is, wherever that may be.
    if (shared.members.size() > 1) k.add_shared(shared);
  }
}

void ClusterSet::find_stiffness(int cluster, const Positions& x, Definiteness definiteness,
                                SharedStiffness& shared) const {
  const ClusterShapes::Shape& shape = shapes_.shape(cluster);
  shared.members.clear();
  for (int k = shape.begin; k < shape.end; ++k) {
    const ClusterShapes::Member& m = shapes_.member(k);
    if (m.mass == 0.0) continue;
    Eigen::Vector4d load;
    load << m.mass * m.rest, m.mass;
    shared.members.push_back({m.particle, shape.stiffness * m.mass, load});
  }
  const ClusterTwists twists(moment(cluster, x, shapes_.center(shape, x)), shapes_.spread(shape),
                             definiteness);
  const double root = std::sqrt(shape.stiffness);
  shared.move = root / std::sqrt(shape.mass);
  for (int k = 0; k < SharedStiffness::kTurns; ++k) {
    shared.turns[static_cast<std::size_t>(k)] = root * twists.turn(k);
  }
}

void ClusterSet::reset() {
  for (Motion& fit : fits_) fit.setIdentity();
}

void ClusterSet::save(StateArchive& numbers) const {
  shapes_.save(numbers);
  for (const Motion& fit : fits_) numbers.write_all(rotation_of(fit));
}

void ClusterSet::load(StateArchive& numbers) {
  shapes_.load(numbers);
  changed();
  turned_spins_.clear();
  for (Motion& fit : fits_) {
    Eigen::Matrix3d rotation;
    numbers.read_all(rotation);
    fit = motion_of(rotation, Eigen::Vector3d::Zero());
  }
}

void ClusterSet::relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) {
  const std::vector<int>& begins = shapes_.begins();
  for (std::size_t color = 0; color + 1 < begins.size(); ++color) {
    parallel_for(begins[color], begins[color + 1], kClusterGrain, [&](int begin, int end) {
      for (int n = begin; n < end; ++n) {
        relax(shapes_.order()[static_cast<std::size_t>(n)], inverse_mass, dt * dt, x);
      }
    });
  }
}

void ClusterSet::relax(int cluster, const Eigen::VectorXd& inverse_mass, double dt2, Positions& x) {
  const ClusterShapes::Shape& shape = shapes_.shape(cluster);
  if (shape.mass == 0.0) return;
  const Motion best = fits_[static_cast<std::size_t>(cluster)] = fit(cluster, x);
  const Eigen::Matrix3d rotation = rotation_of(best);
  const Eigen::Vector3d center = best.topRightCorner<3, 1>();
  // With R held, particle i moves by h² wᵢ Δλᵢ and the centre by c = Σ mᵢ/M of that:
  //   Δλᵢ (1 + h² wᵢ k mᵢ) = fᵢ - λᵢ + k mᵢ c,
  // a scalar equation for c.
  const auto missing = [&](int k) -> Eigen::Vector3d {
    const ClusterShapes::Member& m = shapes_.member(k);
    const Eigen::Vector3d apart = x.col(m.particle) - center - rotation * m.rest;
    return -shape.stiffness * m.mass * apart - multipliers_.col(k);
  };
  const auto divisor = [&](const ClusterShapes::Member& m) {
    return 1.0 + dt2 * inverse_mass[m.particle] * shape.stiffness * m.mass;
  };
  Eigen::Vector3d above = Eigen::Vector3d::Zero();
  double below = 0.0;
  for (int k = shape.begin; k < shape.end; ++k) {
    const ClusterShapes::Member& m = shapes_.member(k);
    above += m.mass * dt2 * inverse_mass[m.particle] / divisor(m) * missing(k);
    below += m.mass / divisor(m);
  }
  const Eigen::Vector3d shift = above / below;
  for (int k = shape.begin; k < shape.end; ++k) {
    const ClusterShapes::Member& m = shapes_.member(k);
    const Eigen::Vector3d delta = (missing(k) + shape.stiffness * m.mass * shift) / divisor(m);
    multipliers_.col(k) += delta;
    x.col(m.particle) += dt2 * inverse_mass[m.particle] * delta;
  }
}

}  // namespace pliant
