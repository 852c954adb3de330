#include "pliant/effects/damping.h"

#include <cmath>

#include "pliant/core/body.h"

namespace pliant {

void DampingEffect::after_step(Body& body, double dt) {
  body.model->system().scale_velocities(std::exp(-rate_ * dt));
}

bool DampingEffect::join_resident_run(ResidentRun& run) const {
  run.velocity_factor *= std::exp(-rate_ * run.dt);
  return true;
}

EffectRegistry::Entry damping_entry() {
  return {
      "damping",
      "velocities decay at a rate, as in still air",
      {number_parameter("rate", "1/s", "0.5", 0.0, 1e6, "share of the velocity lost per second")},
      {"cloth", "patch", "reduced", "viscoelastic", "rigid"},
      [](const Parameters& parameters, const EffectSite&) {
        return std::make_unique<DampingEffect>(parameters.number("rate"));
      }};
}

}  // namespace pliant
