// An effect of its own package: a place that pulls every particle, the more the farther it is.
#include <pliant/core/body.h>
#include <pliant/scene/extensions.h>

namespace {

class Magnet final : public pliant::Effect {
 public:
  Magnet(const Eigen::Vector3d& place, double rate) : place_(place), rate_(rate) {}
  std::string_view name() const override { return "magnet"; }

  void before_step(pliant::Body& body, double) override {
    pliant::System& system = body.model->system();
    const pliant::Particles& p = system.particles;
    for (int i = 0; i < p.size(); ++i) {
      system.external_forces.col(i) += p.mass[i] * rate_ * rate_ * (place_ - p.x.col(i));
    }
  }
  double potential_energy(const pliant::Body& body) const override {
    const pliant::Particles& p = body.particles();
    return 0.5 * rate_ * rate_ * (p.x.colwise() - place_).colwise().squaredNorm().dot(p.mass);
  }

 private:
  Eigen::Vector3d place_;  // [m]
  double rate_;            // angular frequency of a free body about the place [rad/s]
};

void extend() {
  pliant::add_effect(
      {"magnet",
       "pulls every particle to a place, the more the farther it is",
       {pliant::vector_parameter("place", "m", "[0, 0, 0]", 1e3, "in the world frame"),
        pliant::positive_parameter("rate", "rad/s", "6.2831853", 1e3, "of a free body about it")},
       {"cloth", "patch", "viscoelastic", "rigid"},
       [](const pliant::Parameters& parameters, const pliant::EffectSite&) {
         return std::make_unique<Magnet>(parameters.vector("place"), parameters.number("rate"));
       }});
}

}  // namespace

PLIANT_EXTENSION(extend)
