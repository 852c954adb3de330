#include "pliant/elements/cluster_set.h"

#include <cmath>
#include <utility>

#include "pliant/core/parallel.h"
#include "pliant/elements/cluster_rotation.h"
#include "pliant/math/rotation_eigen.h"

namespace pliant {
namespace {
constexpr int kClusterGrain = 32;
constexpr int kParticleGrain = 128;
}  // namespace

ClusterSet::ClusterSet(const Positions& rest, const Eigen::VectorXd& masses,
                       const std::vector<Cluster>& clusters)
    : ClusterSet("cluster", rest, masses, clusters) {}

ClusterSet::ClusterSet(std::string name, const Positions& rest, const Eigen::VectorXd& masses,
                       const std::vector<Cluster>& clusters)
    : name_(std::move(name)), shapes_(name_, rest, masses, clusters) {
  fits_.resize(clusters.size());
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

Eigen::Matrix3d ClusterSet::moment(int cluster, const Positions& x,
                                   const Eigen::Vector3d& center) const {
  const ClusterShapes::Shape& shape = shapes_.shape(cluster);
  Eigen::Matrix3d moment = shapes_.moment(shape, x, center);
  if (spins_.empty()) return moment;
  for (int k = shape.begin; k < shape.end; ++k) {
    const auto i = static_cast<std::size_t>(shapes_.member(k).particle);
    moment += shapes_.member(k).weight * orientations_[i] * spins_[i];
  }
  return moment;
}

ClusterSet::Fit ClusterSet::fit(int cluster, const Positions& x) const {
  const ClusterShapes::Shape& shape = shapes_.shape(cluster);
  Fit fit;
  fit.center = shapes_.center(shape, x);
  const Eigen::Matrix3d a = moment(cluster, x, fit.center);
  const bool always_free = shape.straight && spins_.empty();
  // Bits that depend on history only where the answer does.
  fit.rotation = always_free
                     ? nearest_rotation(a).toRotationMatrix()
                     : cluster_rotation(a, fits_[static_cast<std::size_t>(cluster)].rotation);
  return fit;
}

const std::vector<ClusterSet::Fit>& ClusterSet::fit_all(const Positions& x) const {
  parallel_for(0, size(), kClusterGrain, [&](int begin, int end) {
    for (int c = begin; c < end; ++c) fits_[static_cast<std::size_t>(c)] = fit(c, x);
  });
  return fits_;
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
    const Fit now = any_grows ? fit(c, x) : Fit();
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& m = shapes_.member(k);
      const double weight = weights[m.particle];
      Eigen::Vector3d rest = m.rest;
      if (grows(m)) {
        const Eigen::Vector3d here = now.rotation.transpose() * (x.col(m.particle) - now.center);
        rest = (m.weight * m.rest + (weight - m.weight) * here) / weight;
      }
      shapes_.set_member(k, weight, rest);
    }
    shapes_.rebalance(c);
  }
}

void ClusterSet::creep(const Positions& x, double yield, double share) {
  for (int c = 0; c < size(); ++c) {
    const ClusterShapes::Shape& shape = shapes_.shape(c);
    if (shape.mass == 0.0) continue;
    const Fit now = fit(c, x);
    const auto here = [&](const ClusterShapes::Member& m) -> Eigen::Vector3d {
      return now.rotation.transpose() * (x.col(m.particle) - now.center);
    };
    double apart = 0.0, size = 0.0;
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& m = shapes_.member(k);
      apart += m.mass * (here(m) - m.rest).squaredNorm();
      size += m.mass * m.rest.squaredNorm();
    }
    const double strain = size > 0.0 ? std::sqrt(apart / size) : 0.0;
    if (!(strain > yield)) continue;
    const double way = share * (1.0 - yield / strain);
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& m = shapes_.member(k);
      shapes_.set_member(k, m.weight, m.rest + way * (here(m) - m.rest));
    }
    shapes_.rebalance(c);
  }
}

double ClusterSet::energy(int cluster, const Positions& x) const {
  const ClusterShapes::Shape& shape = shapes_.shape(cluster);
  if (shape.mass == 0.0) return 0.0;
  const Fit best = fit(cluster, x);
  double sum = 0.0;
  for (int k = shape.begin; k < shape.end; ++k) {
    const ClusterShapes::Member& m = shapes_.member(k);
    sum += m.mass * (x.col(m.particle) - best.center - best.rotation * m.rest).squaredNorm();
    if (spins_.empty()) continue;
    // ∫ρ |(O - R) r|² = tr((O - R) D (O - R)ᵀ)
    const auto i = static_cast<std::size_t>(m.particle);
    const Eigen::Matrix3d turn = orientations_[i] - best.rotation;
    sum += m.weight * (turn * spins_[i]).cwiseProduct(turn).sum();
  }
  return 0.5 * shape.stiffness * sum;
}

double ClusterSet::energy(const Positions& x) const {
  double sum = 0.0;
  for (int c = 0; c < size(); ++c) sum += energy(c, x);
  return sum;
}

void ClusterSet::add_forces(const Positions& x, Forces& f) const {
  fit_all(x);
  // Each particle gathers from its clusters in their order.
  parallel_for(0, particles(), kParticleGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      Eigen::Vector3d force = Eigen::Vector3d::Zero();
      for (int n = incidence_begin(i); n < incidence_begin(i + 1); ++n) {
        const auto [cluster, member] = incidence(n);
        const ClusterShapes::Member& m = shapes_.member(member);
        const Fit& fit = fits_[static_cast<std::size_t>(cluster)];
        const Eigen::Vector3d apart = x.col(i) - fit.center - fit.rotation * m.rest;
        force -= shapes_.shape(cluster).stiffness * m.mass * apart;
      }
      f.col(i) += force;
    }
  });
}

void ClusterSet::add_to_system(SystemMatrix& a) const {
  // k (diag(m) - m mᵀ / M)
  for (int c = 0; c < size(); ++c) {
    const ClusterShapes::Shape& shape = shapes_.shape(c);
    if (shape.mass == 0.0) continue;
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& row = shapes_.member(k);
      a.add(row.particle, row.particle, shape.stiffness * row.mass);
      for (int l = shape.begin; l < shape.end; ++l) {
        const ClusterShapes::Member& column = shapes_.member(l);
        // The product first, so that the matrix is symmetric to the bit.
        a.add(row.particle, column.particle,
              -(row.mass * column.mass) * (shape.stiffness / shape.mass));
      }
    }
  }
}

void ClusterSet::add_stiffness(const Positions& x, Definiteness definiteness,
                               StiffnessMatrix& k) const {
  for (int c = 0; c < size(); ++c) add_stiffness(c, x, definiteness, k);
}

void ClusterSet::add_stiffness(int cluster, const Positions& x, Definiteness definiteness,
                               StiffnessMatrix& k) const {
  const ClusterShapes::Shape& shape = shapes_.shape(cluster);
  if (shape.mass == 0.0) return;
  const ClusterTwists twists(moment(cluster, x, shapes_.center(shape, x)), shapes_.spread(shape),
                             definiteness);
  for (int r = shape.begin; r < shape.end; ++r) {
    const ClusterShapes::Member& row = shapes_.member(r);
    const Eigen::Matrix3d left = row.mass * twists.directions(row.rest) * twists.weights();
    for (int n = shape.begin; n < shape.end; ++n) {
      const ClusterShapes::Member& column = shapes_.member(n);
      const double mass = (r == n ? row.mass : 0.0) - row.mass * column.mass / shape.mass;
      const Eigen::Matrix3d block = mass * Eigen::Matrix3d::Identity() -
                                    column.mass * left * twists.directions(column.rest).transpose();
      k.add(row.particle, column.particle, shape.stiffness * block);
    }
  }
}

void ClusterSet::reset() {
  for (Fit& fit : fits_) fit = Fit();
}

void ClusterSet::save(SavedNumbers& numbers) const {
  shapes_.save(numbers);
  for (const Fit& fit : fits_) numbers.write_all(fit.rotation);
}

void ClusterSet::load(SavedNumbers& numbers) {
  shapes_.load(numbers);
  for (Fit& fit : fits_) numbers.read_all(fit.rotation);
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
  Fit& best = fits_[static_cast<std::size_t>(cluster)];
  best = fit(cluster, x);
  // With R held, particle i moves by h² wᵢ Δλᵢ and the centre by c = Σ mᵢ/M of that:
  //   Δλᵢ (1 + h² wᵢ k mᵢ) = fᵢ - λᵢ + k mᵢ c,
  // a scalar equation for c.
  const auto missing = [&](int k) -> Eigen::Vector3d {
    const ClusterShapes::Member& m = shapes_.member(k);
    const Eigen::Vector3d apart = x.col(m.particle) - best.center - best.rotation * m.rest;
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
