#pragma once

#include "pliant/core/effect.h"
#include "pliant/elements/solids/volume_set.h"

namespace pliant {

/// Volume preservation of a body's tetrahedra besides its material's own, and what error it leaves.
class VolumeEffect final : public Effect {
 public:
  /// Adds its element set to `system`, before the solver is prepared. Throws InputError as
  /// VolumeSet does, and then nothing changed.
  VolumeEffect(const TetrahedralMesh& rest, ProjectiveSystem& system, double stiffness,
               const VolumeLimits& limits);
  std::string_view name() const override { return "volume"; }
  /// Reports `volume_error`, the largest |V/V₀ - 1| of a tetrahedron, and `mean_volume_error`.
  void after_step(Body& body, double dt) override;

 private:
  const VolumeSet* set_;  // the system's
};

EffectRegistry::Entry volume_entry();

}  // namespace pliant
