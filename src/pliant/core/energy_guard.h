#pragma once

#include <vector>

#include "pliant/core/body.h"
#include "pliant/core/obstacle.h"

namespace pliant {

/// Whether a part of a step gave its body energy that nothing worked for. A dissipative step ends
/// with
///   kinetic + elastic + couplings' potential energy  <=  what they were + work,
/// work being that of external forces (gravity, wind, the user's) along the way of each particle,
/// and of obstacles that moved. Where iterations end early, contact tunnels or no place is left,
/// it can be otherwise: that is an answer that must not stand.
class EnergyGuard {
 public:
  /// Before a part of a step: external forces are those of the part, attachments are where they go.
  void begin(const Body& body);
  /// After the solver, `reactions` being the forces on obstacles in this part: the energy beyond
  /// what is explained and beyond a tolerance [J]; 0: none, or nobody can say.
  double gained(const Body& body, const std::vector<Obstacle>& obstacles,
                const std::vector<Reaction>& reactions);
  /// Takes `energy` [J] from what the solver changed of the velocities, or as much of it as there
  /// is; what forces would have given without it stays.
  static void take(System& system, double energy, double dt);

 private:
  static bool can_say(const Body& body);
  static double energy_of(const Body& body);

  bool is_watching_ = false;
  double kinetic_ = 0.0, other_ = 0.0;  // before the part [J]
};

}  // namespace pliant
