#include "pliant/core/applied_force.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/math/error.h"

namespace pliant {
namespace {

void require_finite(const std::string& field, bool finite) {
  if (!finite) throw InputError("apply_force: '" + field + "' must be finite");
}

std::vector<int> within(const Particles& particles, const Eigen::Vector3d& point, double radius) {
  std::vector<int> found;
  for (int i = 0; i < particles.size(); ++i) {
    if ((particles.x.col(i) - point).norm() <= radius) found.push_back(i);
  }
  return found;
}

/// Body and particle nearest to `point`.
std::pair<int, int> nearest(const std::vector<const Particles*>& bodies,
                            const Eigen::Vector3d& point) {
  std::pair<int, int> best{-1, -1};
  double best_distance = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b]->size() == 0) continue;
    Eigen::Index i = 0;
    const double distance = (bodies[b]->x.colwise() - point).colwise().squaredNorm().minCoeff(&i);
    if (distance < best_distance) {
      best_distance = distance;
      best = {static_cast<int>(b), static_cast<int>(i)};
    }
  }
  return best;
}

void pick(AppliedForces::Active& active, const std::vector<const Particles*>& bodies) {
  const AppliedForce& request = active.request;
  active.particles.assign(bodies.size(), {});
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    active.particles[b] = within(*bodies[b], request.point, request.radius);
  }
  const auto none = [](const std::vector<int>& list) { return list.empty(); };
  if (std::all_of(active.particles.begin(), active.particles.end(), none)) {
    const auto [body, particle] = nearest(bodies, request.point);
    if (body >= 0) active.particles[static_cast<std::size_t>(body)].push_back(particle);
  }
  active.mass = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (int i : active.particles[b]) active.mass += bodies[b]->mass[i];
  }
}

}  // namespace

void AppliedForces::add(const AppliedForce& force) {
  require_finite("point", force.point.allFinite());
  require_finite("force", force.force.allFinite());
  require_finite("radius", std::isfinite(force.radius));
  require_finite("start", std::isfinite(force.start));
  require_finite("duration", std::isfinite(force.duration));
  if (force.radius < 0.0) {
    throw InputError("apply_force: 'radius' is " + std::to_string(force.radius) +
                     ", but must be >= 0 [m]; 0 takes the nearest vertex");
  }
  Active active;
  active.request = force;
  active_.push_back(std::move(active));
}

void AppliedForces::begin_step(double time, double dt,
                               const std::vector<const Particles*>& bodies) {
  for (Active& active : active_) {
    if (active.started || active.request.start >= time + dt) continue;
    active.started = true;
    const double duration = active.request.duration;
    // A force acts in whole steps: zero seconds is one step, and round-off adds none.
    const double whole = std::max(1.0, std::round(duration / dt)) * dt;
    active.end = duration < 0.0 ? std::numeric_limits<double>::infinity() : time + whole;
    pick(active, bodies);
  }
}

void AppliedForces::add_to(int body, const Particles& particles, Forces& forces) const {
  for (const Active& active : active_) {
    if (!active.started || active.mass == 0.0) continue;
    const Eigen::Vector3d acceleration = active.request.force / active.mass;
    for (int i : active.particles[static_cast<std::size_t>(body)]) {
      forces.col(i) += particles.mass[i] * acceleration;
    }
  }
}

void AppliedForces::end_step(double time) {
  const auto ended = [time](const Active& active) {
    return active.started && active.end <= time * (1.0 + 1e-12);
  };
  active_.erase(std::remove_if(active_.begin(), active_.end(), ended), active_.end());
}

}  // namespace pliant
