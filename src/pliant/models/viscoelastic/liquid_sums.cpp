#include "pliant/models/viscoelastic/liquid_sums.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pliant/laws/sph_pairs.h"
#include "pliant/math/widest.h"

namespace pliant {
namespace {

// Neighbours whose kernels are computed together.
constexpr int kBlock = 64;
using Four = double __attribute__((vector_size(4 * sizeof(double))));

/// The positions of up to kBlock neighbours from a particle's own one, and what it takes of them.
struct Neighbors {
  Four apart[kBlock];      // and in the last number the difference of volumes, which nothing uses
  double squared[kBlock];  // distances
  double volume[kBlock];
};

inline void look_at(const LiquidParticle* particles, const Four& own, const int* list, int count,
                    Neighbors& found) {
  for (int k = 0; k < count; ++k) {
    Four other;
    std::memcpy(&other, particles[list[k]].x, sizeof other);
    const Four apart = own - other;
    const Four squares = apart * apart;
    found.apart[k] = apart;
    found.squared[k] = (squares[0] + squares[1]) + squares[2];
    found.volume[k] = other[3];
  }
}

PLIANT_WIDEST void fill_range(const LiquidSums& s, int begin, int end, double* sums) {
  Neighbors found;
  double terms[kBlock];
  const double self = s.kernels.spiky(0.0);
  for (int rank = begin; rank < end; ++rank) {
    Four own;
    std::memcpy(&own, s.particles[rank].x, sizeof own);
    double sum = own[3] * self;
    const int *list = s.lists.begin(rank), *last = s.lists.end(rank);
    for (; list < last; list += kBlock) {
      const int count = static_cast<int>(std::min<std::ptrdiff_t>(kBlock, last - list));
      look_at(s.particles, own, list, count, found);
      for (int k = 0; k < count; ++k) {
        terms[k] = found.volume[k] * s.kernels.spiky(std::sqrt(found.squared[k]));
      }
      for (int k = 0; k < count; ++k) sum += terms[k];
    }
    sums[rank] = sum;
  }
}

/// What they are made of.
struct Matter {
  double pressure[kBlock], viscosity[kBlock], beta[kBlock], part[kBlock];
};

inline void look_at(const LiquidParticle* particles, const int* list, int count, Matter& found) {
  for (int k = 0; k < count; ++k) {
    const LiquidParticle& other = particles[list[k]];
    found.pressure[k] = other.pressure;
    found.viscosity[k] = other.viscosity;
    found.beta[k] = other.beta;
    found.part[k] = other.part;
  }
}

/// w Vᵢ Vⱼ.
inline double weight_of(const LiquidParticle& own, const Neighbors& others, const Matter& matter,
                        int k) {
  return sph_pair_weight(own.beta, matter.beta[k], own.part == matter.part[k]) *
         (own.volume * others.volume[k]);
}

inline double viscosity_of(const LiquidParticle& own, const Matter& matter, int k) {
  return sph_pair_viscosity(own.viscosity, matter.viscosity[k]);
}

PLIANT_WIDEST void push_range(const LiquidSums& s, int begin, int end, double* forces) {
  Neighbors found;
  Matter matter;
  double pull[kBlock], drag[kBlock];
  for (int rank = begin; rank < end; ++rank) {
    const LiquidParticle& particle = s.particles[rank];
    Four own, speed, force = {0.0, 0.0, 0.0, 0.0};
    std::memcpy(&own, particle.x, sizeof own);
    std::memcpy(&speed, particle.v, sizeof speed);
    const int *list = s.lists.begin(rank), *last = s.lists.end(rank);
    for (; list < last; list += kBlock) {
      const int count = static_cast<int>(std::min<std::ptrdiff_t>(kBlock, last - list));
      look_at(s.particles, own, list, count, found);
      look_at(s.particles, list, count, matter);
      // No branch, so that all lanes of a register do the same. Beyond the support both kernels
      // are 0.
      for (int k = 0; k < count; ++k) {
        const double r = std::sqrt(found.squared[k]);
        const double pair = weight_of(particle, found, matter, k);
        pull[k] = sph_pull(s.kernels, pair, particle.pressure + matter.pressure[k], r);
        drag[k] = sph_drag(s.kernels, pair, viscosity_of(particle, matter, k), r);
      }
      for (int k = 0; k < count; ++k) {
        Four other;
        std::memcpy(&other, s.particles[list[k]].v, sizeof other);
        force -= pull[k] * found.apart[k];
        force -= drag[k] * (speed - other);
      }
    }
    double* to = forces + 3 * static_cast<std::ptrdiff_t>(rank);
    for (int c = 0; c < 3; ++c) to[c] = force[c];
  }
}

PLIANT_WIDEST void lose_range(const LiquidSums& s, int begin, int end, const double* others,
                              double* losses) {
  Neighbors found;
  Matter matter;
  double drag[kBlock];
  for (int rank = begin; rank < end; ++rank) {
    const LiquidParticle& particle = s.particles[rank];
    Four own, speed, later;
    std::memcpy(&own, particle.x, sizeof own);
    std::memcpy(&speed, particle.v, sizeof speed);
    std::memcpy(&later, others + 4 * static_cast<std::ptrdiff_t>(rank), sizeof later);
    double sum = 0.0;
    const int *list = s.lists.begin(rank), *last = s.lists.end(rank);
    for (; list < last; list += kBlock) {
      const int count = static_cast<int>(std::min<std::ptrdiff_t>(kBlock, last - list));
      look_at(s.particles, own, list, count, found);
      look_at(s.particles, list, count, matter);
      for (int k = 0; k < count; ++k) {
        const double r = std::sqrt(found.squared[k]);
        drag[k] = sph_drag(s.kernels, weight_of(particle, found, matter, k),
                           viscosity_of(particle, matter, k), r);
      }
      for (int k = 0; k < count; ++k) {
        Four other, after;
        std::memcpy(&other, s.particles[list[k]].v, sizeof other);
        std::memcpy(&after, others + 4 * static_cast<std::ptrdiff_t>(list[k]), sizeof after);
        // The last of four numbers is none of the velocities'.
        const Four slip = speed - other;
        const Four terms = slip * (slip + (later - after));
        sum += drag[k] * ((terms[0] + terms[1]) + terms[2]);
      }
    }
    losses[rank] = sum;
  }
}

}  // namespace

void LiquidSums::fill(int begin, int end, double* sums) const {
  fill_range(*this, begin, end, sums);
}

void LiquidSums::push(int begin, int end, double* forces) const {
  push_range(*this, begin, end, forces);
}

void LiquidSums::lose(int begin, int end, const double* others, double* losses) const {
  lose_range(*this, begin, end, others, losses);
}

}  // namespace pliant
