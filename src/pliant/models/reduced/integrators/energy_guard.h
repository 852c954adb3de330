#pragma once

#include "pliant/core/saved_numbers.h"

namespace pliant {

/// What one step did to the energy [J].
struct EnergyChange {
  double error = 0.0;        ///< of the integrator, as far as it can be told exactly
  double before = 0.0;       ///< elastic and kinetic energy
  double after = 0.0;        ///< the same at the step's end
  double work = 0.0;         ///< of the force
  double dissipated = 0.0;   ///< by damping, >= 0
  bool is_strained = false;  ///< whether the step was too long for the motion, and divided
};

/// Holds the energy of a simulation to the balance of work and dissipation, as a last line behind
/// an integrator that keeps it by itself in gentle motion. Two sums are watched:
///   the integrator's own exact errors, which are 0 in linear motion; beyond `share` of the energy
///   they are taken back whole;
///   after - before - work + dissipated, whose swings are as large as the integrator's order
///   allows, at most a quarter of the energy where h ω = 1; it is held to 3 `share` and in strained
///   steps only, so that gentle motion never meets it.
class EnergyGuard {
 public:
  explicit EnergyGuard(double share) : share_(share) {}
  void reset();
  /// How much to take from the kinetic energy [J] after a step; < 0 gives, 0 leaves it alone.
  /// `kinetic` > 0 is what can be scaled.
  double take(const EnergyChange& step, double kinetic);
  void save(SavedNumbers& numbers) const;
  void load(SavedNumbers& numbers);

 private:
  double share_;
  double gained_ = 0.0;   // sum of errors not yet taken back [J]
  double surplus_ = 0.0;  // sum of what the balance lacks [J]
  bool is_taking_ = false;
};

}  // namespace pliant
