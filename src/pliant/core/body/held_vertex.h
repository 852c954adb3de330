#pragma once

namespace pliant {

/// A spring between a particle and a place that no particle moves.
struct HeldVertex {
  int particle;
  double stiffness;  ///< [N/m]
  bool operator==(const HeldVertex& other) const {
    return particle == other.particle && stiffness == other.stiffness;
  }
};

}  // namespace pliant
