#pragma once

#include "cuda/models/viscoelastic/liquid_sums.h"
#include "cuda/solvers/resident_run/resident_sums.h"
#include "pliant/laws/sph_walls.h"

/// Obstacles that stand still as a liquid feels them (LiquidWalls), in single precision. Lengths
/// over H.
namespace pliant {

/// Obstacle k beside a particle: `distance` over H, from 1 on it is out of reach.
struct WallNear {
  float distance;
  Float3 normal;
};

struct WallsView {
  const DeviceObstacle* obstacles;
  int count;
  float quantum, support;  ///< [m]

  PLIANT_HOST_DEVICE WallNear near(int k, Float3 at) const {
    const DeviceObstacle& obstacle = obstacles[k];
    const DeviceSurfacePoint found = query(obstacle.shape, obstacle.inside(at));
    return {found.distance / support, obstacle.turned(found.normal)};
  }
};

/// What walls fill about each particle.
struct FillWalls {
  WallsView walls;
  const Fixed* x;  ///< by place
  float* filled;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const Float3 at = place(x[i], walls.quantum);
    float open = 1.0f;
    for (int k = 0; k < walls.count; ++k) {
      const float s = walls.near(k, at).distance;
      if (s < 1.0f) open *= 1.0f - wall_filling(unit_kernels(), s);
    }
    filled[i] = 1.0f - open;
  }
};

/// The force of each wall on a particle, from the density that walls helped to make.
struct WallForces {
  WallsView walls;
  MovingParticles particles;
  const int* parts;  ///< null: there is one
  const LiquidConstants* constants;
  const float *filled, *filling;

  /// Calls use(k, force, at).
  template <class Use>
  PLIANT_HOST_DEVICE void for_each(int i, Use& use) const {
    const Float4 motion = particles.v(i);
    if (motion.w == 0.0f) return;
    const Fixed x = particles.x(i);
    const Float3 at = place(x, walls.quantum), v = motion.xyz();
    const LiquidConstants c = constants[parts == nullptr ? 0 : parts[i]];
    const float psi = filling[i], h = walls.support;
    for (int k = 0; k < walls.count; ++k) {
      const WallNear near = walls.near(k, at);
      if (near.distance >= 1.0f) continue;
      const float others =
          (1.0f - filled[i]) / (1.0f - wall_filling(unit_kernels(), near.distance));
      const float push =
          h * h * wall_push(unit_kernels(), others * x.w, c.bulk, psi, near.distance);
      const float drag = h * wall_drag(unit_kernels(), x.w, c.viscosity, near.distance);
      const Float3 along = v - dot(near.normal, v) * near.normal;
      use(k, motion.w * (push * near.normal - drag * along), at);
    }
  }
};

/// Adds them.
struct PushWalls {
  WallForces walls;
  Float4* forces;

  struct Sum {
    Float3 force;
    PLIANT_HOST_DEVICE void operator()(int, Float3 own, Float3) { force += own; }
  };
  PLIANT_HOST_DEVICE void operator()(int i) const {
    Sum sum{forces[i].xyz()};
    walls.for_each(i, sum);
    forces[i] = with_w(sum.force, 0.0f);
  }
};

/// Adds what a block's particles do to the walls, as SumReactions.
struct SumWallReactions {
  static constexpr int kPhases = 2;
  WallForces walls;
  int particles, block, slots;
  float share;
  float* sums;

  struct Write {
    const DeviceObstacle* obstacles;
    float* to;
    PLIANT_HOST_DEVICE void operator()(int k, Float3 force, Float3 at) {
      write_reaction(-1.0f * force, at - obstacles[k].position, to + kReactionNumbers * k);
    }
  };
  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float* shared) const {
    const int count = kReactionNumbers * slots, i = number * block + thread;
    if (phase == 0) {
      for (int k = 0; k < count; ++k) shared[thread * count + k] = 0.0f;
      Write write{walls.walls.obstacles, shared + thread * count};
      if (i < particles) walls.for_each(i, write);
      return;
    }
    add_numbers(shared, count, block, thread, share, sums + number * count);
  }
};

}  // namespace pliant
