#pragma once

#include "pliant/solvers/rigid_part.h"
#include "pliant/solvers/step_objective.h"

namespace pliant {

/// Keeps iterations that end early from making energy from nowhere.
///
/// The forces that they leave unbalanced, b = r + f_c with those of the couplings, are missing in
/// the step: it is exact with −b added, a force that no law brings. Where E is convex its work is
/// the only energy that can come in,
///   E(x') + T(x') <= E(x) + T(y) + W,  W = −b(x') · d,  d = x' − x from the step's start,
/// T the kinetic energy, y the prediction. W is the slope of the objective along d: where it is
/// positive, a smaller part of the same way has none.
class UnbalancedWork {
 public:
  /// Moves the particles back on their way as far as W asks. `forces` hold r at the present
  /// positions and are overwritten. A body that nothing holds or touches keeps its momentum and
  /// angular momentum.
  void hold(ProjectiveSystem& system, const StepObjective& objective, Forces& forces,
            StepReport& report);

 private:
  void take_way(const ProjectiveSystem& system);
  /// b from r.
  void take_balance(const ProjectiveSystem& system, const Forces& forces);
  /// The share of the way at which W is none; `held` is the work of the couplings' forces.
  double share(ProjectiveSystem& system, const StepObjective& objective, double work, double held,
               Forces& forces, StepReport& report);
  void go(Positions& x, double share) const;

  Positions end_, way_;
  Forces balance_;
  RigidPart rigid_part_;
};

}  // namespace pliant
