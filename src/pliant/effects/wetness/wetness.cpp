#include "pliant/effects/wetness/wetness.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/body.h"
#include "pliant/effects/contact/contact.h"
#include "pliant/effects/gravity.h"
#include "pliant/effects/self_contact/self_contact.h"

namespace pliant {
namespace {

// Solvers are prepared anew, which takes longer than a step, only where the mass of a vertex is off
// by this share of what it weighs.
constexpr double kMassShare = 0.01;
// Of a time step: times that differ by less are the same.
constexpr double kSameTime = 1e-6;

}  // namespace

WetnessEffect::WetnessEffect(const EffectSite& site, Wettable& wettable, const Options& options)
    : obstacles_(site.obstacles),
      wettable_(wettable),
      options_(options),
      areas_(site.body.model->particle_areas()),
      dry_mass_(site.body.particles().mass),
      mass_(dry_mass_),
      flow_(site.body.particles().x, site.body.model->surface_triangles(), areas_, options.rates) {
  contact_.range = options.adhesion_range;
  contact_.adhesion.setZero(areas_.size());
  contact_.friction_factor.setOnes(areas_.size());
  start(site.body.particles());
  wettable.show_wetness(&wetness_);
  for (const auto& effect : site.body.effects) {
    if (auto* touching = effect->find<TakesWetness>()) touching->set_wetness(&contact_);
  }
}

void WetnessEffect::start(const Particles& particles) {
  time_ = 0.0;
  mass_ = particles.mass;
  wetness_.setZero(areas_.size());
  sprinkle(particles, 0.0);
  dip(particles);
  follow();
}

void WetnessEffect::sprinkle(const Particles& particles, double dt) {
  const double end = options_.from + options_.duration;
  // The step in which all of it comes, or such that bring a share of it.
  const double slack = kSameTime * dt;
  const bool is_due = time_ >= options_.from - slack && time_ - dt < end - slack;
  if (!is_due && !(dt == 0.0 && options_.from == 0.0 && options_.duration == 0.0)) return;
  const double share = options_.duration > 0.0 ? std::min(1.0, dt / options_.duration) : 1.0;
  for (int i = 0; i < wetness_.size(); ++i) {
    const bool is_within =
        options_.radius == 0.0 || (particles.x.col(i) - options_.center).norm() <= options_.radius;
    if (!is_within || wetness_[i] >= options_.wetness) continue;
    wetness_[i] = std::min(options_.wetness, wetness_[i] + share * options_.wetness);
  }
}

void WetnessEffect::dip(const Particles& particles) {
  for (const Obstacle& obstacle : obstacles_) {
    if (!obstacle.liquid) continue;
    const Eigen::Isometry3d local = obstacle.pose_end.inverse();
    for (int i = 0; i < wetness_.size(); ++i) {
      if (obstacle.shape->distance(local * particles.x.col(i)) <= 0.0) wetness_[i] = 1.0;
    }
  }
}

void WetnessEffect::dry(double dt) {
  const double lost = dt * options_.drying / options_.capacity;
  wetness_ = (wetness_.array() - lost).max(0.0);
}

Eigen::Vector3d WetnessEffect::up(const Body& body) const {
  const GravityEffect* gravity = body.find<GravityEffect>();
  if (gravity == nullptr) return Eigen::Vector3d::Zero();
  return -gravity->acceleration().stableNormalized();
}

void WetnessEffect::after_step(Body& body, double dt) {
  time_ += dt;
  if (options_.rates.moves()) flow_.flow(body.particles().x, up(body), dt, wetness_);
  if (options_.drying > 0.0) dry(dt);
  sprinkle(body.particles(), dt);
  dip(body.particles());
  follow();
}

void WetnessEffect::follow(int i) {
  const double w = wetness_[i];
  contact_.adhesion[i] = w * options_.adhesion * areas_[i];
  contact_.friction_factor[i] = 1.0 + w * (options_.friction_factor - 1.0);
  const double mass = dry_mass_[i] + w * options_.capacity * areas_[i];
  const bool is_final = (w == 0.0 || w == 1.0) && mass != mass_[i];
  if (!is_final && std::abs(mass - mass_[i]) <= kMassShare * mass) return;
  mass_[i] = mass;
  wettable_.set_mass(i, mass);
}

void WetnessEffect::follow() {
  for (int i = 0; i < wetness_.size(); ++i) follow(i);
}

double WetnessEffect::water() const { return options_.capacity * wetness_.dot(areas_); }

double WetnessEffect::permeability(int i) const {
  const double w = wetness_[i];
  return options_.permeability * (1.0 - w) * (1.0 - w) * (1.0 - w * w);
}

std::vector<SettableField> WetnessEffect::settable_fields() {
  return {{number_parameter("wetness", "", "", 0.0, 1.0, "share of the water that it can hold"),
           {},
           [this](int i) { return wetness_[i]; },
           [this](int i, double wetness) {
             wetness_[i] = wetness;
             follow(i);
           }}};
}

void WetnessEffect::reset(Body& body) { start(body.particles()); }

void WetnessEffect::save(StateArchive& numbers) const {
  numbers.write(time_);
  numbers.write(wettable_.masses_changed ? 1.0 : 0.0);
  numbers.write_all(wetness_);
  numbers.write_all(mass_);
}

void WetnessEffect::load(StateArchive& numbers) {
  time_ = numbers.read();
  const bool masses_changed = numbers.read() == 1.0;
  numbers.read_all(wetness_);
  numbers.read_all(mass_);
  for (int i = 0; i < mass_.size(); ++i) wettable_.set_mass(i, mass_[i]);
  follow();
  wettable_.masses_changed = masses_changed;
}

EffectRegistry::Entry wetness_entry() {
  return {
      "wetness",
      "water in cloth: mass, no air through the weave, friction, adhesion; it drains and dries",
      {number_parameter("wetness", "", "1", 0.0, 1.0,
                        "of a region of the scene, as share of what the cloth can hold"),
       vector_parameter("center", "m", "[0, 0, 0]", 1e9, "of the region, a ball, in the world"),
       number_parameter("radius", "m", "0", 0.0, 1e9, "of the region; 0: the whole cloth"),
       number_parameter("from", "s", "0", 0.0, 1e9, "when the region begins to get wet"),
       number_parameter("duration", "s", "0", 0.0, 1e9, "over which it gets wet; 0: at once"),
       positive_parameter("capacity", "kg/m^2", "0.2", 1e3,
                          "water in the full cloth: thickness x porosity x 1000 kg/m^3"),
       number_parameter("adhesion", "Pa", "1440", 0.0, 1e6,
                        "pull that the full cloth withstands on an obstacle: 2 gamma / range, the "
                        "suction of water (gamma = 0.072 N/m) between two wetted faces"),
       positive_parameter("adhesion_range", "m", "1e-4", 0.1,
                          "gap up to which it pulls; adhesion x range is the work per area to peel "
                          "it off: take a larger range and less adhesion for coarse cloth"),
       positive_parameter("friction_factor", "", "2", 100.0, "of the full cloth on friction"),
       number_parameter("permeability", "m/(s Pa)", "2.5e-3", 0.0, 1.0,
                        "of the dry weave for air, added to that of the effect air; the full "
                        "weave's is 0"),
       number_parameter("diffusion", "m^2/s", "0", 0.0, 1.0, "of water in the cloth"),
       number_parameter("drainage", "m/s", "0", 0.0, 1.0,
                        "speed at which water sinks in full cloth that hangs"),
       number_parameter("drying", "kg/(m^2 s)", "0", 0.0, 1.0, "water lost to the air")},
      {"cloth"},
      [](const Parameters& given, const EffectSite& site) {
        auto* wettable = site.body.model->find<Wettable>();
        if (wettable == nullptr) throw InputError("effect 'wetness' needs a body of cloth");
        WetnessEffect::Options options;
        options.wetness = given.number("wetness");
        options.center = given.vector("center");
        options.radius = given.number("radius");
        options.from = given.number("from");
        options.duration = given.number("duration");
        options.capacity = given.number("capacity");
        options.adhesion = given.number("adhesion");
        options.adhesion_range = given.number("adhesion_range");
        options.friction_factor = given.number("friction_factor");
        options.permeability = given.number("permeability");
        options.rates = {given.number("diffusion"), given.number("drainage")};
        options.drying = given.number("drying");
        return std::make_unique<WetnessEffect>(site, *wettable, options);
      }};
}

}  // namespace pliant
