#include "pliant/effects/strain_limit.h"

#include "pliant/core/body.h"

namespace pliant {

StrainLimitEffect::StrainLimitEffect(const TetrahedralMesh& rest, ProjectiveSystem& system,
                                     double stiffness, const StretchLimits& limits) {
  auto set = std::make_unique<StrainLimitSet>(rest, stiffness, limits);
  set_ = set.get();
  system.elements.push_back(std::move(set));
}

void StrainLimitEffect::after_step(Body& body, double) {
  body.report.add_figure("largest_strain", set_->largest_strain(body.particles().x));
}

EffectRegistry::Entry strain_limit_entry() {
  return {"strain_limit",
          "limits the stretches of tetrahedra: free between them, stiff beyond",
          {positive_parameter("min", "", "0.8", 1.0, "least principal stretch without force"),
           number_parameter("max", "", "1.2", 1.0, 1e3, "largest principal stretch without force"),
           positive_parameter("stiffness", "Pa", "1e6", 1e15,
                              "beyond the limits, as Young's modulus of one direction")},
          {"patch"},
          [](const Parameters& parameters, const EffectSite& site) {
            return std::make_unique<StrainLimitEffect>(
                *site.body.model->tetrahedra(),
                dynamic_cast<ProjectiveSystem&>(site.body.model->system()),
                parameters.number("stiffness"),
                StretchLimits{parameters.number("min"), parameters.number("max")});
          }};
}

}  // namespace pliant
