#pragma once

#include "pliant/core/state_archive.h"

namespace pliant {

/// What one step did to the energy [J].
struct EnergyChange {
  double before = 0.0;      ///< elastic and kinetic energy
  double after = 0.0;       ///< the same at the step's end
  double work = 0.0;        ///< of the force
  double dissipated = 0.0;  ///< by damping, >= 0
};

/// Holds the energy of a simulation to the balance of work and dissipation, as a last line behind
/// an integrator that keeps it by itself in gentle motion. What is watched is the sum of
///   after - before - work + dissipated,
/// which is 0 in linear motion and swings about it in any other; beyond `share` of the energy it is
/// taken back. Where others change the state between steps, contact or attachments, each step
/// begins anew out of the integrator's own motion and errs to one side: there the sum forgets the
/// past.
class EnergyGuard {
 public:
  explicit EnergyGuard(double share) : share_(share) {}
  void reset();
  /// How much to take from the kinetic energy [J] after a step; < 0 gives, 0 leaves it alone.
  /// `kinetic` > 0 is what can be scaled.
  double take(const EnergyChange& step, double kinetic);
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  double share_;
  double surplus_ = 0.0;  // of the balance, not yet taken back [J]
  double after_ = 0.0;    // the energy that the last step left [J]
  bool is_taking_ = false;
};

}  // namespace pliant
