#include "pliant/effects/self_contact.h"

#include <utility>

#include "pliant/core/body.h"

namespace pliant {
SelfContactEffect::SelfContactEffect(SelfContactParts parts, const Options& options)
    : detection_(std::move(parts), options), pairs_(options.thickness) {}

void SelfContactEffect::reset(Body&) { pairs_.all().clear(); }

void SelfContactEffect::begin_step(const Particles& particles, double dt) {
  detection_.find(particles, dt, pairs_.all());
}

void SelfContactEffect::report(StepReport& report) const { report.contacts += active(); }

EffectRegistry::Entry self_contact_entry() {
  return {
      "self_contact",
      "keeps the bodies of a scene out of each other and each out of itself, with friction",
      {positive_parameter("thickness", "m", "0.002", 1.0, "distance that surfaces keep"),
       number_parameter("margin", "m", "0.0005", 0.0, 1.0,
                        "contacts open by less than this take part in the iterations"),
       number_parameter("friction", "", "0.5", 0.0, 100.0,
                        "Coulomb coefficient, static and dynamic")},
      {"patch"},
      [](const Parameters& parameters, const EffectSite& site) {
        const Model& model = *site.body.model;
        return std::make_unique<SelfContactEffect>(
            SelfContactParts(*model.tetrahedra(), model.surface_triangles(), model.surface_points(),
                             model.contact_points()),
            SelfContactEffect::Options{parameters.number("thickness"), parameters.number("margin"),
                                       parameters.number("friction")});
      }};
}

}  // namespace pliant
