#include "pliant/effects/strain_limit/strain_limit.h"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "pliant/core/body.h"
#include "pliant/effects/strain_limit/cloth_strain_limit.h"
#include "pliant/math/error.h"

namespace pliant {

StrainLimitEffect::StrainLimitEffect(const TetrahedralMesh& rest, ProjectiveSystem& system,
                                     double stiffness, const StretchLimits& limits) {
  auto set = std::make_unique<StrainLimitSet>(rest, stiffness, limits);
  set_ = set.get();
  system.elements.push_back(std::move(set));
}

void StrainLimitEffect::after_step(Body& body, double) {
  body.report.add_metric("largest_strain", set_->largest_strain(body.particles().x));
}

namespace {

constexpr const char* kLeastStretch = "0.8";
constexpr const char* kStiffness = "1e6";  // [Pa]

void refuse_what_cloth_has_not(const Parameters& parameters) {
  for (const auto& [name, unset] :
       {std::pair("min", kLeastStretch), std::pair("stiffness", kStiffness)}) {
    if (parameters.number(name) == std::stod(unset)) continue;
    throw InputError(
        fmt::format("effect 'strain_limit': '{}' is for tetrahedra; of cloth 'max' alone is "
                    "limited, and holds: leave '{}' out",
                    name, name));
  }
}

std::unique_ptr<Effect> make_strain_limit(const Parameters& parameters, const EffectSite& site) {
  ProjectiveSystem& system = *site.body.model->system().as_projective();
  const double min = parameters.number("min"), max = parameters.number("max");
  if (const TetrahedralMesh* rest = site.body.model->tetrahedra()) {
    return std::make_unique<StrainLimitEffect>(*rest, system, parameters.number("stiffness"),
                                               StretchLimits{min, max});
  }
  refuse_what_cloth_has_not(parameters);
  return std::make_unique<ClothStrainLimit>(system, max);
}

}  // namespace

EffectRegistry::Entry strain_limit_entry() {
  return {"strain_limit",
          "limits stretches: of tetrahedra, free between the limits and stiff beyond; of cloth "
          "along warp and weft, by a limit that holds",
          {positive_parameter("min", "", kLeastStretch, 1.0,
                              "least principal stretch of tetrahedra without force; yarns of "
                              "cloth buckle instead"),
           number_parameter("max", "", "1.2", 1.0, 1e3,
                            "largest principal stretch of tetrahedra without force; largest "
                            "stretch of cloth"),
           positive_parameter("stiffness", "Pa", kStiffness, 1e15,
                              "of tetrahedra beyond the limits, as Young's modulus of one "
                              "direction")},
          {"cloth", "patch"},
          make_strain_limit};
}

}  // namespace pliant
