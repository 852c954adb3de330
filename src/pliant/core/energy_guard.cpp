#include "pliant/core/energy_guard.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/core/columns.h"
#include "pliant/core/effect.h"
#include "pliant/core/solver.h"

namespace pliant {
namespace {

// Of the energies and works of the part. Iterations that end early are off by a tenth and more in
// scenes that stay bounded; what grows by more than this doubles within three steps.
constexpr double kTolerance = 0.25;
// Contacts push out what is in them by less than their distance; of all that lies still, this speed
// is no gain yet [m/s].
constexpr double kStill = 0.02;

/// By an obstacle's motion, of the force on it.
double work_on(const Obstacle& obstacle, const Reaction& reaction) {
  const Eigen::Vector3d way =
      obstacle.pose_end.translation() - obstacle.pose_start.translation();
  const Eigen::AngleAxisd turn(obstacle.pose_end.linear() *
                               obstacle.pose_start.linear().transpose());
  return reaction.force.dot(way) + turn.angle() * reaction.torque.dot(turn.axis());
}

}  // namespace

bool EnergyGuard::can_say(const Body& body) {
  return body.solver->is_dissipative() &&
         std::none_of(body.effects.begin(), body.effects.end(),
                      [](const auto& effect) { return effect->gives_energy(); });
}

double EnergyGuard::energy_of(const Body& body) {
  double energy = body.model->system().elastic_energy();
  for (const auto& effect : body.effects) {
    // That of forces which do not depend on the answer is in their work.
    if (effect->coupling() != nullptr) energy += effect->potential_energy(body);
  }
  return energy;
}

void EnergyGuard::begin(const Body& body) {
  // What a scene puts into obstacles is pushed out in its first step, whatever that takes.
  is_watching_ = body.report.step > 1 && can_say(body);
  if (!is_watching_) return;
  kinetic_ = body.model->system().kinetic_energy();
  other_ = energy_of(body);
}

double EnergyGuard::gained(const Body& body, const std::vector<Obstacle>& obstacles,
                           const std::vector<Reaction>& reactions) {
  if (!is_watching_) return 0.0;
  const System& system = body.model->system();
  const Particles& p = system.particles;
  struct Sums {
    double work = 0.0, mass = 0.0;
  };
  const Sums sums = parallel_reduce(
      0, p.size(), kColumnGrain,
      [&](int begin, int end) {
        Sums part;
        for (int i = begin; i < end; ++i) {
          part.work += system.external_forces.col(i).dot(p.x.col(i) - p.x_start.col(i));
          part.mass += p.mass[i];
        }
        return part;
      },
      [](const Sums& a, const Sums& b) { return Sums{a.work + b.work, a.mass + b.mass}; });
  double by_obstacles = 0.0;
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    by_obstacles -= work_on(obstacles[o], reactions[o]);
  }
  const double gain =
      system.kinetic_energy() + energy_of(body) - kinetic_ - other_ - sums.work - by_obstacles;
  const double scale =
      kinetic_ + std::abs(other_) + std::abs(sums.work) + std::abs(by_obstacles);
  const double allowed = kTolerance * scale + 0.5 * sums.mass * kStill * kStill;
  return gain > allowed ? gain : 0.0;
}

void EnergyGuard::take(System& system, double energy, double dt) {
  Particles& p = system.particles;
  // |v + (s − 1) u|², u being what the solver changed, as a s² + 2 b s + c.
  struct Sums {
    double a = 0.0, b = 0.0;
  };
  const auto forced = [&](int i) -> Eigen::Vector3d {
    return p.v_start.col(i) + dt * p.inverse_mass[i] * system.external_forces.col(i);
  };
  const Sums sums = parallel_reduce(
      0, p.size(), kColumnGrain,
      [&](int begin, int end) {
        Sums part;
        for (int i = begin; i < end; ++i) {
          if (p.is_fixed(i)) continue;
          const Eigen::Vector3d w = forced(i), u = p.v.col(i) - w;
          part.a += p.mass[i] * u.squaredNorm();
          part.b += p.mass[i] * u.dot(w);
        }
        return part;
      },
      [](const Sums& one, const Sums& other) { return Sums{one.a + other.a, one.b + other.b}; });
  // The kinetic energy at s is 1/2 (a s² + 2 b s + c): the largest share s of at most 1 with which
  // it is `energy` less, or the one with which it is least.
  const double goal = sums.a + 2.0 * sums.b - 2.0 * energy;
  const double inside = sums.b * sums.b + sums.a * goal;
  if (!(sums.a > 0.0)) return;
  const double share = std::clamp((std::sqrt(std::max(0.0, inside)) - sums.b) / sums.a, 0.0, 1.0);
  parallel_for(0, p.size(), kColumnGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      if (p.is_fixed(i)) continue;
      const Eigen::Vector3d w = forced(i);
      p.v.col(i) = w + share * (p.v.col(i) - w);
    }
  });
}

}  // namespace pliant
