#include "pliant/core/body/applied_force.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/math/error.h"

namespace pliant {
namespace {

void require_finite(const std::string& field, bool finite) {
  if (!finite) throw InputError("apply_force: '" + field + "' must be finite");
}

std::vector<int> within(const ForcePoints& points, const Eigen::Vector3d& center, double radius) {
  std::vector<int> found;
  for (int i = 0; i < points.size(); ++i) {
    if ((points.position(i) - center).norm() <= radius) found.push_back(i);
  }
  return found;
}

bool is_meant(const AppliedForce& request, std::size_t body) {
  return request.body < 0 || request.body == static_cast<int>(body);
}

/// Body and point nearest to the request's.
std::pair<int, int> nearest(const std::vector<ForcePoints>& bodies, const AppliedForce& request) {
  std::pair<int, int> best{-1, -1};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (int i = 0; is_meant(request, b) && i < bodies[b].size(); ++i) {
      const double distance = (bodies[b].position(i) - request.point).squaredNorm();
      if (!(distance < least)) continue;
      least = distance;
      best = {static_cast<int>(b), i};
    }
  }
  return best;
}

void pick(AppliedForces::Active& active, const std::vector<ForcePoints>& bodies) {
  const AppliedForce& request = active.request;
  active.points.assign(bodies.size(), {});
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (is_meant(request, b)) {
      active.points[b] = within(bodies[b], request.point, request.radius);
    }
  }
  const auto none = [](const std::vector<int>& list) { return list.empty(); };
  if (std::all_of(active.points.begin(), active.points.end(), none)) {
    const auto [body, point] = nearest(bodies, request);
    if (body >= 0) active.points[static_cast<std::size_t>(body)].push_back(point);
  }
  active.mass = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (int i : active.points[b]) active.mass += bodies[b].mass(i);
  }
}

}  // namespace

void ForcePoints::add(int i, const Eigen::Vector3d& force, Forces& forces) const {
  if (!embedded_) {
    forces.col(i) += force;
    return;
  }
  for (int k = 0; k < 4; ++k) {
    forces.col(embedded_->particles()(k, i)) += embedded_->weights()(k, i) * force;
  }
}

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

int AppliedForces::clear(int body) {
  const auto kept = std::remove_if(active_.begin(), active_.end(), [body](const Active& active) {
    return active.request.body == body;
  });
  const auto count = static_cast<int>(active_.end() - kept);
  active_.erase(kept, active_.end());
  return count;
}

void AppliedForces::begin_step(double time, double dt, const std::vector<ForcePoints>& bodies) {
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

void AppliedForces::add_to(int body, const ForcePoints& points, Forces& forces) const {
  for (const Active& active : active_) {
    if (!active.started || active.mass == 0.0) continue;
    const Eigen::Vector3d acceleration = active.request.force / active.mass;
    for (int i : active.points[static_cast<std::size_t>(body)]) {
      points.add(i, points.mass(i) * acceleration, forces);
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
