#include "pliant/effects/gravity.h"

#include "pliant/core/body.h"
#include "pliant/core/columns.h"

namespace pliant {

void GravityEffect::before_step(Body& body, double) {
  System& system = body.model->system();
  const Particles& particles = system.particles;
  for_each_column(system.external_forces, [&](int i) {
    system.external_forces.col(i) += particles.mass[i] * acceleration_;
  });
}

double GravityEffect::potential_energy(const Body& body) const {
  return -acceleration_.dot(body.particles().x * body.particles().mass);
}

EffectRegistry::Entry gravity_entry() {
  return {"gravity",
          "uniform acceleration of every particle",
          {vector_parameter("acceleration", "m/s^2", "[0, 0, -9.81]", 1e4, "in the world frame")},
          {"cloth", "patch", "reduced", "viscoelastic", "rigid"},
          [](const Parameters& parameters, const EffectSite&) {
            return std::make_unique<GravityEffect>(parameters.vector("acceleration"));
          }};
}

}  // namespace pliant
