#pragma once

#include "cuda/models/viscoelastic/liquid_sums.h"

/// Sums over neighbours for effects (PairSums), by particle. Lengths over H, volumes over H³.
namespace pliant {

/// Particles by rank.
struct EffectView {
  GridView grid;
  const Float4* motion = nullptr;  ///< v and beta
  const Float2* beside = nullptr;  ///< what a sum needs besides
};

namespace effect_sums {

/// Σ min(β) w w ∇W.
struct Cohesion {
  EffectView view;
  Float4* sums;

  struct Sum {
    const EffectView& view;
    float beta, volume;
    Float3 sum;
    PLIANT_HOST_DEVICE void operator()(int j, float s, Float3 apart) {
      sum +=
          cohesion_slope(unit_kernels(), beta, view.motion[j].w, volume, view.grid.x[j].w, s * s) *
          apart;
    }
  };
  PLIANT_HOST_DEVICE void operator()(int rank) const {
    Sum sum{view, view.motion[rank].w, view.grid.x[rank].w, {0.0f, 0.0f, 0.0f}};
    sum_near(view.grid, rank, sum);
    sums[view.grid.order[rank]] = with_w(sum.sum, 0.0f);
  }
};

/// min(β) min(m) min(w) W of a particle and its neighbour j; `beside` holds m.
PLIANT_HOST_DEVICE inline float mixing(const EffectView& view, int j, const Float4& own,
                                       float volume, float mass, float s) {
  return xsph_weight(own.w, view.motion[j].w, mass, view.beside[j].x, volume, view.grid.x[j].w) *
         unit_kernels().poly6(s * s);
}

/// Σ of that times vⱼ − vᵢ.
struct Mixing {
  EffectView view;
  Float4* sums;

  struct Sum {
    const EffectView& view;
    Float4 own;
    float volume, mass;
    Float3 sum;
    PLIANT_HOST_DEVICE void operator()(int j, float s, Float3) {
      sum += mixing(view, j, own, volume, mass, s) * (view.motion[j].xyz() - own.xyz());
    }
  };
  PLIANT_HOST_DEVICE void operator()(int rank) const {
    Sum sum{view, view.motion[rank], view.grid.x[rank].w, view.beside[rank].x, {0.0f, 0.0f, 0.0f}};
    sum_near(view.grid, rank, sum);
    sums[view.grid.order[rank]] = with_w(sum.sum, 0.0f);
  }
};

/// The same of |vⱼ − vᵢ|².
struct MixingSquares {
  EffectView view;
  double* sums;

  struct Sum {
    const EffectView& view;
    Float4 own;
    float volume, mass;
    double sum;
    PLIANT_HOST_DEVICE void operator()(int j, float s, Float3) {
      const Float3 apart = view.motion[j].xyz() - own.xyz();
      sum += static_cast<double>(mixing(view, j, own, volume, mass, s) * dot(apart, apart));
    }
  };
  PLIANT_HOST_DEVICE void operator()(int rank) const {
    Sum sum{view, view.motion[rank], view.grid.x[rank].w, view.beside[rank].x, 0.0};
    sum_near(view.grid, rank, sum);
    sums[view.grid.order[rank]] = sum.sum;
  }
};

/// Σ wⱼ ∇W.
struct ColorSlope {
  EffectView view;
  Float4* sums;

  struct Sum {
    const Fixed* x;
    Float3 sum;
    PLIANT_HOST_DEVICE void operator()(int j, float s, Float3 apart) {
      sum += (x[j].w * unit_kernels().poly6_slope(s * s)) * apart;
    }
  };
  PLIANT_HOST_DEVICE void operator()(int rank) const {
    Sum sum{view.grid.x, {0.0f, 0.0f, 0.0f}};
    sum_near(view.grid, rank, sum);
    sums[view.grid.order[rank]] = with_w(sum.sum, 0.0f);
  }
};

/// Σ w w k ∇²W (Tⱼ − Tᵢ); `beside` holds T and the part, `between` k of `parts` x `parts`.
struct Conduction {
  EffectView view;
  const float* between;
  int parts;
  double* sums;

  struct Sum {
    const EffectView& view;
    const float* row;
    float volume, temperature;
    double sum;
    PLIANT_HOST_DEVICE void operator()(int j, float s, Float3) {
      const Float2 other = view.beside[j];
      const float pair = (volume * view.grid.x[j].w) * unit_kernels().viscosity_laplacian(s);
      sum += static_cast<double>(row[static_cast<int>(other.y)] * (pair * (other.x - temperature)));
    }
  };
  PLIANT_HOST_DEVICE void operator()(int rank) const {
    const Float2 own = view.beside[rank];
    Sum sum{view, between + parts * static_cast<int>(own.y), view.grid.x[rank].w, own.x, 0.0};
    sum_near(view.grid, rank, sum);
    sums[view.grid.order[rank]] = sum.sum;
  }
};

}  // namespace effect_sums

struct GatherBeside {
  const int* order;
  const Float2* from;
  Float2* to;
  PLIANT_HOST_DEVICE void operator()(int rank) const { to[rank] = from[order[rank]]; }
};

}  // namespace pliant
