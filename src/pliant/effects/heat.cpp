#include "pliant/effects/heat.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/body.h"
#include "pliant/core/neighbor_lists.h"
#include "pliant/math/error.h"
#include "pliant/math/sph_kernels.h"

namespace pliant {
namespace {

// Share of H² ρ c / k; as for the liquid's viscosity.
constexpr double kStable = 0.07;
// Heat may lag behind the motion by this [s]: it is slow, and a step may be taken in many parts.
constexpr double kLargestStep = 0.01;
// Share of the support: nearer particles are taken to be so far from a wall.
constexpr double kNearest = 0.125;

}  // namespace

HeatEffect::HeatEffect(Body& body, BlendedParticles& blend, const std::vector<Obstacle>& obstacles,
                       const HeatMaterial& material, const Surroundings& surroundings)
    : body_(body),
      blend_(blend),
      obstacles_(obstacles),
      material_(material),
      surroundings_(surroundings) {
  const int n = body.particles().size();
  temperature_.setConstant(n, surroundings.initial_temperature);
  heat_.resize(n);
  rate_.resize(n);
  start(body.particles());
  blend.show_field("temperature", &temperature_);
}

void HeatEffect::reset(Body& body) { start(body.particles()); }

void HeatEffect::start(const Particles& particles) {
  pending_ = 0.0;
  temperature_.setConstant(surroundings_.initial_temperature);
  heat_ = material_.enthalpy(surroundings_.initial_temperature) * particles.mass;
  follow(particles);
}

void HeatEffect::save(SavedNumbers& numbers) const {
  numbers.write(pending_);
  numbers.write_all(heat_);
  numbers.write_all(temperature_);
}

void HeatEffect::load(SavedNumbers& numbers) {
  pending_ = numbers.read();
  numbers.read_all(heat_);
  numbers.read_all(temperature_);
  for (int i = 0; i < temperature_.size(); ++i) {
    const double share = material_.liquid_share(temperature_[i]);
    blend_.set_beta(i, surroundings_.solid_beta + (1.0 - surroundings_.solid_beta) * share);
  }
}

void HeatEffect::follow(const Particles& particles) {
  for (int i = 0; i < heat_.size(); ++i) {
    temperature_[i] = material_.temperature(heat_[i] / particles.mass[i]);
    const double share = material_.liquid_share(temperature_[i]);
    blend_.set_beta(i, surroundings_.solid_beta + (1.0 - surroundings_.solid_beta) * share);
  }
}

void HeatEffect::set_temperature(int particle, double temperature) {
  heat_[particle] = material_.enthalpy(temperature) * body_.particles().mass[particle];
  temperature_[particle] = temperature;
}

std::vector<SettableField> HeatEffect::settable_fields() {
  SettableField temperature{number_parameter("temperature", "K", "", 0.0, 1e5, "of the body"),
                            {},
                            [this](int i) { return temperature_[i]; },
                            [this](int i, double kelvin) { set_temperature(i, kelvin); }};
  SettableField beta{};
  beta.spec.name = "beta";
  beta.why_not = "with the effect 'heat' it follows the temperature; set 'temperature'";
  return {std::move(temperature), std::move(beta)};
}

double HeatEffect::stable_step() const {
  // Where it melts it takes up more heat, so that this is the least.
  const double lightest = material_.capacity;
  double density = 0.0;
  if (heat_.size() > 0) {
    const double h = material_.enthalpy(temperature_[0]);
    density = heat_[0] / h / blend_.volumes()[0];
  }
  const double support = blend_.support();
  return kStable * support * support * density * lightest /
         std::max(material_.conductivity, 1e-300);
}

void HeatEffect::after_step(Body& body, double dt) {
  pending_ += dt;
  const double largest = std::min(kLargestStep, stable_step());
  // A step that ends a little early by round-off is one all the same.
  if (pending_ < largest * (1.0 - 1e-9)) return;
  const int steps = static_cast<int>(std::ceil(pending_ / largest * (1.0 - 1e-9)));
  find_surroundings(body.particles());
  for (int k = 0; k < steps; ++k) exchange(body.particles(), pending_ / steps);
  pending_ = 0.0;
}

void HeatEffect::find_surroundings(const Particles& particles) {
  const SphKernels kernels(blend_.support());
  const NeighborLists& lists = blend_.neighbors(particles.x);
  const Eigen::VectorXd& volumes = blend_.volumes();
  slope_.resize(3, particles.size());
  lists.for_each_point([&](int rank, int i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    lists.for_each_neighbor(rank, [&](int o) {
      const Eigen::Vector3d apart = particles.x.col(i) - particles.x.col(o);
      sum += volumes[o] * kernels.poly6_slope(apart.squaredNorm()) * apart;
    });
    slope_.col(i) = sum;
  });
  walls_.clear();
  for (const Obstacle& obstacle : obstacles_) {
    const Eigen::Isometry3d local = obstacle.pose_end.inverse();
    for (int i = 0; i < particles.size(); ++i) {
      const SurfacePoint surface = obstacle.shape->query(local * particles.x.col(i));
      if (surface.distance >= kernels.support()) continue;
      const double distance = std::max(0.0, surface.distance);
      const double facing = kernels.poly6_push_beyond(distance);
      slope_.col(i) -= facing * (obstacle.pose_end.linear() * surface.normal);
      if (!obstacle.temperature) continue;
      // The particles within reach of a wall share its area, ∫ of twice `facing` over the distance.
      const double through =
          surroundings_.wall_conductance > 0.0
              ? 2.0 * volumes[i] * facing * surroundings_.wall_conductance
              : volumes[i] * material_.conductivity / kSphLaplacian *
                    kernels.viscosity_drag_beyond(std::max(kNearest * kernels.support(), distance));
      walls_.push_back({i, through, *obstacle.temperature});
    }
  }
  air_ = 2.0 * surroundings_.convection * volumes.cwiseProduct(slope_.colwise().norm().transpose());
}

void HeatEffect::exchange(const Particles& particles, double dt) {
  const SphKernels kernels(blend_.support());
  const NeighborLists& lists = blend_.neighbors(particles.x);
  const Eigen::VectorXd& volumes = blend_.volumes();
  lists.for_each_point([&](int rank, int i) {
    double sum = 0.0;
    lists.for_each_neighbor(rank, [&](int o) {
      const double r = (particles.x.col(i) - particles.x.col(o)).norm();
      const double pair = (volumes[i] * volumes[o]) * kernels.viscosity_laplacian(r);
      sum -= pair / kSphLaplacian * (temperature_[i] - temperature_[o]);
    });
    rate_[i] =
        material_.conductivity * sum + air_[i] * (surroundings_.air_temperature - temperature_[i]);
  });
  for (const Wall& wall : walls_) {
    rate_[wall.particle] += wall.flux_per_kelvin * (wall.temperature - temperature_[wall.particle]);
  }
  heat_ += dt * rate_;
  follow(particles);
}

EffectRegistry::Entry heat_entry() {
  return {
      "heat",
      "temperature of particles: conduction, air, hot and cold obstacles; what melts becomes "
      "liquid, what freezes solid",
      {number_parameter("initial_temperature", "K", "293.15", 0.0, 1e5, "of the body"),
       positive_parameter("melting_point", "K", "305", 1e5, "middle of the melting range"),
       positive_parameter("melting_range", "K", "4", 1e4, "from all solid to all liquid"),
       number_parameter("latent_heat", "J/kg", "1e5", 0.0, 1e9, "of melting"),
       positive_parameter("capacity", "J/(kg K)", "2000", 1e9, "heat per mass and kelvin"),
       number_parameter("conductivity", "W/(m K)", "0.2", 0.0, 1e6, "of the body"),
       number_parameter("solid_beta", "", "0", 0.0, 1.0, "blend of what is not melted"),
       number_parameter("air_temperature", "K", "293.15", 0.0, 1e5, "about the body"),
       number_parameter("convection", "W/(m^2 K)", "10", 0.0, 1e9,
                        "heat to the air per area and kelvin; 0: none"),
       number_parameter("wall_conductance", "W/(m^2 K)", "0", 0.0, 1e12,
                        "of the surface of obstacles that have a temperature; 0: they touch "
                        "perfectly")},
      {"viscoelastic"},
      [](const Parameters& given, const EffectSite& site) {
        HeatMaterial material{given.number("capacity"), given.number("conductivity"),
                              given.number("latent_heat"), given.number("melting_point"),
                              given.number("melting_range")};
        HeatEffect::Surroundings around{given.number("initial_temperature"),
                                        given.number("solid_beta"), given.number("air_temperature"),
                                        given.number("convection"),
                                        given.number("wall_conductance")};
        auto* blend = dynamic_cast<BlendedParticles*>(site.body.model.get());
        if (blend == nullptr) throw InputError("effect 'heat' needs a body of particles");
        return std::make_unique<HeatEffect>(site.body, *blend, site.obstacles, material, around);
      }};
}

}  // namespace pliant
