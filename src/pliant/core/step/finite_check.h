#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pliant/core/body/particles.h"

namespace pliant {

/// Decides after each step whether a body's state may be kept.
struct FiniteCheck {
  double max_speed = 1e4;     ///< a faster particle counts as a blow-up [m/s]
  double max_distance = 1e6;  ///< a particle further from the origin counts as a blow-up [m]

  /// First particle that is not finite or out of bounds, if any; where some were not finite before
  /// the step, the first of those.
  std::optional<int> first_bad(const Particles& particles) const;
  std::string message(const Particles& particles, int bad, const std::string& body,
                      const std::string& solver, double time, double dt) const;
};

}  // namespace pliant
