#include "pliant/effects/particles/plasticity.h"

#include <cmath>

#include "pliant/core/body.h"
#include "pliant/math/error.h"

namespace pliant {

void PlasticityEffect::after_step(Body& body, double dt) {
  blend_.creep(body.particles().x, yield_, 1.0 - std::exp(-rate_ * dt));
}

EffectRegistry::Entry plasticity_entry() {
  return {"plasticity",
          "solids keep what deforms them beyond a yield strain, and creep",
          {number_parameter("yield", "", "0.05", 0.0, 1e3,
                            "strain up to which they spring back; 0: they creep under any load"),
           number_parameter("rate", "1/s", "10", 0.0, 1e6,
                            "share of the strain beyond it that becomes their shape per second")},
          {"viscoelastic"},
          [](const Parameters& given, const EffectSite& site) {
            auto* blend = site.body.model->find<BlendedParticles>();
            if (blend == nullptr) throw InputError("effect 'plasticity' needs a body of particles");
            return std::make_unique<PlasticityEffect>(*blend, given.number("yield"),
                                                      given.number("rate"));
          }};
}

}  // namespace pliant
