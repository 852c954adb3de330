#include "pliant/effects/contact/particle_contact_detection.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

// What is more liquid than this keeps apart by its pressure alone.
constexpr double kMostLiquid = 0.5;
// In sizes of the largest ball: nobody looks further, so that a wild step does not list all pairs.
constexpr double kFarthest = 8.0;

/// The direction in which two balls touch, from the offset between them before and how it changes;
/// zero where they come no nearer than `reach`.
Eigen::Vector3d touching_direction(const Eigen::Vector3d& apart, const Eigen::Vector3d& change,
                                   double least, double reach) {
  const double a = change.squaredNorm(), b = apart.dot(change),
               c = apart.squaredNorm() - least * least;
  Eigen::Vector3d at = apart;
  if (c > 0.0 && a > 0.0) {
    const double nearest = std::clamp(-b / a, 0.0, 1.0);
    const double root = b * b - a * c;
    // The first of the two times at which |apart + t change| = least, where there is one.
    const double meet = b < 0.0 && root >= 0.0 ? c / (-b + std::sqrt(root)) : 2.0;
    at = apart + std::min(meet, nearest) * change;
  }
  const double distance = at.norm();
  if (!(distance <= reach)) return Eigen::Vector3d::Zero();
  // Coincident particles have no direction to leave in.
  return distance > 0.0 ? Eigen::Vector3d(at / distance) : Eigen::Vector3d::UnitX();
}

}  // namespace

ParticleContactDetection::ParticleContactDetection(BlendedParticles& blend, const Options& options)
    : blend_(blend), options_(options) {
  sizes_ = blend.volumes().array().pow(1.0 / 3.0).max(options.thickness);
}

double ParticleContactDetection::reach(const Particles& particles) const {
  const double largest = sizes_.maxCoeff();
  const Positions displacements = particles.x - particles.x_start;
  const Eigen::Vector3d mean = displacements.rowwise().mean();
  const double spread =
      std::sqrt((displacements.colwise() - mean).colwise().squaredNorm().maxCoeff());
  const double wanted = largest + options_.margin + 2.0 * spread;
  return wanted <= kFarthest * largest ? wanted : kFarthest * largest + options_.margin;
}

void ParticleContactDetection::find(const Particles& particles, double dt,
                                    std::vector<PairContact>& contacts) {
  contacts.clear();
  if (particles.size() == 0) return;
  lists_.build(particles.x_start, reach(particles));
  const Eigen::VectorXd& beta = blend_.beta();
  for (int rank = 0; rank < lists_.size(); ++rank) {
    const int i = lists_.order()[static_cast<std::size_t>(rank)];
    if (beta[i] > kMostLiquid) continue;
    lists_.for_each_neighbor(rank, [&](int j) {
      if (i < j && beta[j] <= kMostLiquid) add(particles, i, j, dt, contacts);
    });
  }
}

void ParticleContactDetection::add(const Particles& particles, int i, int j, double dt,
                                   std::vector<PairContact>& contacts) const {
  const Eigen::Vector3d apart = particles.x_start.col(i) - particles.x_start.col(j);
  const Eigen::Vector3d change = particles.x.col(i) - particles.x.col(j) - apart;
  const double least = this->least(i, j);
  const Eigen::Vector3d normal = touching_direction(apart, change, least, least + options_.margin);
  if (normal.isZero(0.0) || blend_.are_bound(i, j)) return;
  PairContact contact;
  contact.count = 2;
  contact.particles = {i, j};
  contact.weights = {1.0, -1.0};
  contact.normal = normal;
  // What lies too near is opened slowly.
  contact.least = std::min(least, apart.norm() + kMaxPushOutSpeed * dt);
  contact.start = apart;
  contact.friction = options_.friction;
  contacts.push_back(contact);
}

}  // namespace pliant
