#pragma once

#include "cuda/models/viscoelastic/particle_grid.h"
#include "pliant/laws/sph_pairs.h"

/// Sums over neighbours as Liquid and the effects of particles compute them (src/pliant), in single
/// precision. Lengths are in supports H: volumes V/H³, so that no power of H leaves the range.
namespace pliant {

/// Of the support 1.
PLIANT_HOST_DEVICE inline SphKernels<float> unit_kernels() { return SphKernels<float>(1.0f); }

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
  const Float4* velocity;  ///< times the substep [quanta]
  const Float2* beside;    ///< V/H³ and beta
  float speed;             ///< of one quantum in a substep [m/s]
  PLIANT_HOST_DEVICE Fixed x(int i) const {
    Fixed at = now[i];
    at.w = beside[i].x;
    return at;
  }
  PLIANT_HOST_DEVICE Float4 v(int i) const {
    return with_w(speed * velocity[i].xyz(), beside[i].y);
  }
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
      sum += x[j].w * unit_kernels().spiky(s);
    }
  };
  PLIANT_HOST_DEVICE void operator()(int rank) const {
    Sum near{liquid.grid.x, liquid.grid.x[rank].w * unit_kernels().spiky(0.0f)};
    sum_near(liquid.grid, rank, near);
    const int i = liquid.grid.order[rank];
    const float psi = sph_filling(near.sum + (walls != nullptr ? walls[i] : 0.0f));
    filling[i] = psi;
    liquid.pressure[rank] = sph_pressure(liquid.constants[liquid.part(rank)].bulk, psi);
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
      const float weight = sph_pair_weight(own.w, other.w, other_part == part);
      if (weight == 0.0f) return;
      const float pair = weight * (volume * liquid.grid.x[j].w);
      const float pull = sph_pull(unit_kernels(), pair, pressure + liquid.pressure[j], s);
      const float mean = sph_pair_viscosity(viscosity, liquid.constants[other_part].viscosity);
      force -= (liquid.support * pull) * apart;
      force -= sph_drag(unit_kernels(), pair, mean, s) * (own.xyz() - other.xyz());
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
    forces[liquid.grid.order[rank]] = with_w(liquid.support * sum.force, 0.0f);
  }
};

/// Σ d |vᵢ − vⱼ|² by particle, with PushLiquid's viscous forces d (vⱼ − vᵢ), but for a factor H.
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
      const float pair =
          sph_pair_weight(own.w, other.w, other_part == part) * (volume * liquid.grid.x[j].w);
      const float mean = sph_pair_viscosity(viscosity, liquid.constants[other_part].viscosity);
      const Float3 slip = own.xyz() - other.xyz();
      sum += static_cast<double>(sph_drag(unit_kernels(), pair, mean, s) * dot(slip, slip));
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
