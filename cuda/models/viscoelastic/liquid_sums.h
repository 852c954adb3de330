#pragma once

#include "cuda/models/viscoelastic/particle_grid.h"
#include "pliant/math/sph_kernels.h"

/// Sums over neighbours as Liquid and the effects of particles compute them (src/pliant), in single
/// precision. Lengths are in supports H: volumes V/H³, so that no power of H leaves the range.
namespace pliant {

constexpr float kPiSingle = 3.14159265f;

/// Of the parts of a body.
struct LiquidConstants {
  float bulk;       ///< c² ρ⁰ [Pa]
  float viscosity;  ///< μ [Pa s]
};

/// Particles by rank.
struct LiquidView {
  GridView grid;
  const Float4* motion = nullptr;  ///< v [m/s] and beta
  const int* parts = nullptr;      ///< null: there is one
  const LiquidConstants* constants = nullptr;
  float* pressure = nullptr;  ///< p/ψ² [Pa]
  float support = 1.0f;       ///< H [m]

  PLIANT_HOST_DEVICE int part(int rank) const { return parts == nullptr ? 0 : parts[rank]; }
};

/// Particles as a step's host gives them, by particle.
struct GivenParticles {
  const Fixed* positions;  ///< and V/H³
  const Float4* motion;    ///< v and beta
  PLIANT_HOST_DEVICE Fixed x(int i) const { return positions[i]; }
  PLIANT_HOST_DEVICE Float4 v(int i) const { return motion[i]; }
};

/// And as a resident run moves them, by place.
struct MovingParticles {
  const Fixed* now;
  const Float4* way;     ///< in a substep [quanta]
  const Float2* beside;  ///< V/H³ and beta
  float speed;           ///< of one quantum in a substep [m/s]
  PLIANT_HOST_DEVICE Fixed x(int i) const {
    Fixed at = now[i];
    at.w = beside[i].x;
    return at;
  }
  PLIANT_HOST_DEVICE Float4 v(int i) const { return with_w(speed * way[i].xyz(), beside[i].y); }
};

/// Into the order of ranks.
template <class Particles>
struct GatherParticles {
  const int* order;
  Particles from;
  const int* parts;  // null: there is one
  Fixed* ranked_x;
  Float4* ranked_motion;
  int* ranked_parts;

  PLIANT_HOST_DEVICE void operator()(int rank) const {
    const int i = order[rank];
    ranked_x[rank] = from.x(i);
    ranked_motion[rank] = from.v(i);
    if (parts != nullptr) ranked_parts[rank] = parts[i];
  }
};

/// ψ of each particle, and its pressure.
struct FillLiquid {
  LiquidView liquid;
  const float* walls;  ///< what walls fill, by particle; null: there are none
  float* filling;      ///< ψ, by particle

  struct Sum {
    const Fixed* x;
    float sum;
    PLIANT_HOST_DEVICE void operator()(int j, float s, Float3) {
      const float left = 1.0f - s;
      sum += x[j].w * (left * left * left);
    }
  };
  PLIANT_HOST_DEVICE void operator()(int rank) const {
    Sum near{liquid.grid.x, liquid.grid.x[rank].w};
    sum_near(liquid.grid, rank, near);
    const int i = liquid.grid.order[rank];
    const float sum = 15.0f / kPiSingle * near.sum + (walls != nullptr ? walls[i] : 0.0f);
    const float raw = 1.0f + (sum - static_cast<float>(kSphBulk)) / static_cast<float>(kSphSlope);
    const float psi = raw > 0.0f ? raw : 0.0f;
    filling[i] = psi;
    liquid.pressure[rank] =
        psi > 1.0f ? liquid.constants[liquid.part(rank)].bulk * (psi - 1.0f) / (psi * psi) : 0.0f;
  }
};

/// Pressure and viscosity: forces by particle [N].
struct PushLiquid {
  LiquidView liquid;
  Float4* forces;

  struct Sum {
    const LiquidView& liquid;
    Float4 own;
    float volume, pressure, viscosity;
    int part;
    Float3 force;
    PLIANT_HOST_DEVICE void operator()(int j, float s, Float3 apart) {
      const Float4 other = liquid.motion[j];
      const int other_part = liquid.part(j);
      float weight = own.w > other.w ? own.w : other.w;
      if (other_part != part) weight = 1.0f;
      if (weight == 0.0f) return;
      const float left = 1.0f - s;
      const float pair = weight * (volume * liquid.grid.x[j].w);
      // Coincident particles have no direction to leave in.
      const float slope = s > 0.0f ? left * left / s : 0.0f;
      const float push =
          liquid.support * (pressure + liquid.pressure[j]) * slope / static_cast<float>(kSphSlope);
      const float drag = 0.5f / static_cast<float>(kSphLaplacian) *
                         (viscosity + liquid.constants[other_part].viscosity) * left;
      force += (pair * push) * apart;
      force -= (pair * drag) * (own.xyz() - other.xyz());
    }
  };
  PLIANT_HOST_DEVICE void operator()(int rank) const {
    const int part = liquid.part(rank);
    Sum sum{liquid,
            liquid.motion[rank],
            liquid.grid.x[rank].w,
            liquid.pressure[rank],
            liquid.constants[part].viscosity,
            part,
            {0.0f, 0.0f, 0.0f}};
    sum_near(liquid.grid, rank, sum);
    const float unit = 45.0f / kPiSingle * liquid.support;
    forces[liquid.grid.order[rank]] = with_w(unit * sum.force, 0.0f);
  }
};

/// Σ d |vᵢ − vⱼ|² by particle, with PushLiquid's viscous forces d (vⱼ − vᵢ), without its unit.
struct DragSquares {
  LiquidView liquid;
  double* sums;

  struct Sum {
    const LiquidView& liquid;
    Float4 own;
    float volume, viscosity;
    int part;
    double sum;
    PLIANT_HOST_DEVICE void operator()(int j, float s, Float3) {
      const Float4 other = liquid.motion[j];
      const int other_part = liquid.part(j);
      float weight = own.w > other.w ? own.w : other.w;
      if (other_part != part) weight = 1.0f;
      const float pair = weight * (volume * liquid.grid.x[j].w);
      const float drag = 0.5f / static_cast<float>(kSphLaplacian) *
                         (viscosity + liquid.constants[other_part].viscosity) * (1.0f - s);
      const Float3 slip = own.xyz() - other.xyz();
      sum += static_cast<double>((pair * drag) * dot(slip, slip));
    }
  };
  PLIANT_HOST_DEVICE void operator()(int rank) const {
    const int part = liquid.part(rank);
    Sum sum{
        liquid, liquid.motion[rank], liquid.grid.x[rank].w, liquid.constants[part].viscosity, part,
        0.0};
    sum_near(liquid.grid, rank, sum);
    sums[liquid.grid.order[rank]] = sum.sum;
  }
};

}  // namespace pliant
