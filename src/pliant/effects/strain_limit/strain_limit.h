#pragma once

#include "pliant/core/effect.h"
#include "pliant/elements/solids/strain_limit_set.h"

namespace pliant {

/// Limits to the principal stretches of a body's tetrahedra, beyond which they turn stiff.
class StrainLimitEffect final : public Effect {
 public:
  /// Adds its element set to `system`, before the solver is prepared. Throws InputError as
  /// StrainLimitSet does, and then nothing changed.
  StrainLimitEffect(const TetrahedralMesh& rest, ProjectiveSystem& system, double stiffness,
                    const StretchLimits& limits);
  std::string_view name() const override { return "strain_limit"; }
  /// Reports `largest_strain`, the largest |σ - 1| of all principal stretches σ.
  void after_step(Body& body, double dt) override;

 private:
  const StrainLimitSet* set_;  // the system's
};

EffectRegistry::Entry strain_limit_entry();

}  // namespace pliant
