#pragma once

#include <cmath>

#include "pliant/core/body/particles.h"

namespace pliant {

/// sqrt(Σ m |a − b|² / Σ m) over the particles that are not pinned [m].
inline double rms_distance(const Particles& p, const Positions& a, const Positions& b) {
  double sum = 0.0, mass = 0.0;
  for (int i = 0; i < p.size(); ++i) {
    if (p.is_fixed(i)) continue;
    sum += p.mass[i] * (a.col(i) - b.col(i)).squaredNorm();
    mass += p.mass[i];
  }
  return std::sqrt(sum / mass);
}

}  // namespace pliant
