#include "pliant/effects/volume.h"

#include "pliant/core/body.h"

namespace pliant {

VolumeEffect::VolumeEffect(const TetrahedralMesh& rest, ProjectiveSystem& system, double stiffness,
                           const VolumeLimits& limits) {
  auto set = std::make_unique<VolumeSet>(rest, stiffness, limits);
  set_ = set.get();
  system.elements.push_back(std::move(set));
}

void VolumeEffect::after_step(Body& body, double) {
  const VolumeError error = set_->error(body.particles().x);
  body.report.add_metric("volume_error", error.largest);
  body.report.add_metric("mean_volume_error", error.mean);
}

EffectRegistry::Entry volume_entry() {
  return {
      "volume",
      "keeps the volume of tetrahedra, exactly or within limits, besides what the material does",
      {positive_parameter("stiffness", "Pa", "1e6", 1e15,
                          "as three times the first Lame parameter of a material"),
       positive_parameter("min", "", "1", 1e3, "least volume over that at rest without force"),
       positive_parameter("max", "", "1", 1e3, "largest such volume; at least `min`")},
      {"patch"},
      [](const Parameters& parameters, const EffectSite& site) {
        return std::make_unique<VolumeEffect>(
            *site.body.model->tetrahedra(), *site.body.model->system().as_projective(),
            parameters.number("stiffness"),
            VolumeLimits{parameters.number("min"), parameters.number("max")});
      }};
}

}  // namespace pliant
