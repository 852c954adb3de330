#include "pliant/effects/particles/heat.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/body.h"
#include "pliant/core/system/neighbor_lists.h"
#include "pliant/core/system/pair_sums.h"
#include "pliant/effects/contact/friction.h"
#include "pliant/laws/sph_walls.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

// Share of H² ρ c / k. In it a particle gives the share s of its heat to its neighbours, 15 times
// this, and to walls up to all: no mode grows while 2 s + 1 <= 2. A tenth is for squeezed liquid.
constexpr double kStable = 0.03;
// Heat may lag behind the motion by this [s]: it is slow, and a step may be taken in many substeps.
constexpr double kLargestStep = 0.01;
// Explicit steps that a step of the body may take, and the least number of implicit ones in place
// of more.
constexpr double kMostExplicit = 200.0;
constexpr double kLeastImplicit = 16.0;

/// Of each part's material beside each other's: 2 k k'/(k + k').
template <class Parts>
Eigen::MatrixXd between(const Parts& parts) {
  const auto count = static_cast<Eigen::Index>(parts.size());
  Eigen::MatrixXd means = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = 0; b < count; ++b) {
      const double k = parts[static_cast<std::size_t>(a)].material.conductivity;
      const double other = parts[static_cast<std::size_t>(b)].material.conductivity;
      if (k + other > 0.0) means(a, b) = a == b ? k : 2.0 * k * other / (k + other);
    }
  }
  return means;
}

}  // namespace

HeatEffect::HeatEffect(Body& body, BlendedParticles& blend, const std::vector<Obstacle>& obstacles,
                       const HeatMaterial& material, const Environment& environment)
    : body_(body), blend_(blend), obstacles_(obstacles), environment_(environment) {
  const int n = body.particles().size();
  for (const BlendedParticles::Part& part : blend.blended_parts()) add_part(part, material);
  conductivities_ = between(parts_);
  temperature_.resize(n);
  heat_.resize(n);
  rate_.resize(n);
  start(body.particles());
  blend.show_field("temperature", &temperature_);
  blend.keep_losses();
}

void HeatEffect::add_part(const BlendedParticles::Part& part, const HeatMaterial& material) {
  const HeatProperties& own = part.heat;
  Part added{part.first, part.count, material,
             own.initial_temperature.value_or(environment_.initial_temperature),
             own.solid_beta.value_or(environment_.solid_beta)};
  added.material.capacity = own.capacity.value_or(material.capacity);
  added.material.conductivity = own.conductivity.value_or(material.conductivity);
  added.material.latent_heat = own.latent_heat.value_or(material.latent_heat);
  added.material.melting_point = own.melting_point.value_or(material.melting_point);
  added.material.melting_range = own.melting_range.value_or(material.melting_range);
  part_numbers_.resize(static_cast<std::size_t>(part.first + part.count),
                       static_cast<int>(parts_.size()));
  parts_.push_back(added);
}

void HeatEffect::reset(Body& body) { start(body.particles()); }

void HeatEffect::start(const Particles& particles) {
  pending_ = from_outside_ = from_strain_ = from_motion_ = 0.0;
  for (int i = 0; i < particles.size(); ++i) {
    const Part& part = part_of(i);
    heat_[i] = part.material.enthalpy(part.initial_temperature) * particles.mass[i];
  }
  follow(particles);
}

void HeatEffect::save(StateArchive& numbers) const {
  numbers.write(pending_);
  numbers.write(from_outside_);
  numbers.write(from_strain_);
  numbers.write(from_motion_);
  numbers.write_all(heat_);
  numbers.write_all(temperature_);
}

void HeatEffect::load(StateArchive& numbers) {
  pending_ = numbers.read();
  from_outside_ = numbers.read();
  from_strain_ = numbers.read();
  from_motion_ = numbers.read();
  numbers.read_all(heat_);
  numbers.read_all(temperature_);
  for (int i = 0; i < temperature_.size(); ++i) set_beta(i);
}

void HeatEffect::set_beta(int particle) {
  const Part& part = part_of(particle);
  const double share = part.material.liquid_share(temperature_[particle]);
  blend_.set_beta(particle, part.solid_beta + (1.0 - part.solid_beta) * share);
}

void HeatEffect::follow(const Particles& particles) {
  for (int i = 0; i < heat_.size(); ++i) {
    temperature_[i] = part_of(i).material.temperature(heat_[i] / particles.mass[i]);
    set_beta(i);
  }
}

void HeatEffect::set_temperature(int particle, double temperature) {
  const HeatMaterial& material = part_of(particle).material;
  heat_[particle] = material.enthalpy(temperature) * body_.particles().mass[particle];
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
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const Part& part = parts_[p];
    if (part.count == 0) continue;
    const double density = body_.particles().mass[part.first] / blend_.volumes()[part.first];
    const double best = conductivities_.col(static_cast<Eigen::Index>(p)).maxCoeff();
    // Where it melts it takes up more heat, so that this is the least.
    least = std::min(least, density * part.material.capacity / std::max(best, 1e-300));
  }
  const double support = blend_.support();
  return kStable * support * support * least;
}

void HeatEffect::take(const Eigen::VectorXd& losses, double& sum) {
  if (losses.size() == 0) return;
  heat_ += losses;
  sum += losses.sum();
}

void HeatEffect::after_step(Body& body, double dt) {
  take(blend_.take_losses(), from_strain_);
  take(blend_.take_motion_losses(), from_motion_);
  if (const auto* friction = body.find<FrictionEffect>()) {
    take(friction->losses(body.particles().x), from_motion_);
  }
  pending_ += dt;
  const double largest = std::min(kLargestStep, stable_step());
  // A step that ends a little early by round-off is one all the same.
  if (pending_ < largest * (1.0 - 1e-9)) return;
  // Before anything makes a whole number of it: no integer need hold it.
  const double steps = std::ceil(pending_ / largest * (1.0 - 1e-9));
  find_environment(body.particles());
  if (steps <= kMostExplicit) {
    for (int k = 0; k < static_cast<int>(steps); ++k) exchange(body.particles(), pending_ / steps);
  } else {
    exchange_implicitly(steps, body);
  }
  pending_ = 0.0;
}

void HeatEffect::fill_network(const Particles& particles) {
  const SphKernels kernels(blend_.support());
  const NeighborLists& lists = blend_.neighbors(particles.x);
  const Eigen::VectorXd& volumes = blend_.volumes();
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  const int n = particles.size();
  network_.begins.assign(at(n + 1), 0);
  lists.for_each_point([&](int rank, int i) {
    network_.begins[at(i + 1)] = static_cast<int>(lists.end(rank) - lists.begin(rank));
  });
  for (int i = 0; i < n; ++i) network_.begins[at(i + 1)] += network_.begins[at(i)];
  network_.others.resize(at(network_.begins.back()));
  network_.conductances.resize(network_.others.size());
  lists.for_each_point([&](int rank, int i) {
    int k = network_.begins[at(i)];
    lists.for_each_neighbor(rank, [&](int o) {
      const double r = (particles.x.col(i) - particles.x.col(o)).norm();
      const double pair = (volumes[i] * volumes[o]) * kernels.viscosity_laplacian(r);
      network_.others[at(k)] = o;
      network_.conductances[at(k++)] =
          conductivities_(part_numbers_[at(i)], part_numbers_[at(o)]) * (pair / kSphLaplacian);
    });
  });
  network_.passes = passes_;
  network_.brings = brings_;
  network_.masses = particles.mass;
  network_.materials.resize(at(n));
  for (int i = 0; i < n; ++i) network_.materials[at(i)] = &part_of(i).material;
  network_.prepare();
}

void HeatEffect::exchange_implicitly(double explicit_steps, Body& body) {
  fill_network(body.particles());
  const int steps = static_cast<int>(std::max(kLeastImplicit, std::ceil(pending_ / kLargestStep)));
  body.report.warn(fmt::format(
      "heat_implicit: conduction of this material would take {:.3g} explicit substeps of the step, "
      "more than {:g}: it took {} implicit ones, and what happens within {:.2g} s is smoothed",
      explicit_steps, kMostExplicit, steps, pending_ / steps));
  bool converged = true;
  for (int k = 0; k < steps; ++k) {
    const HeatNetwork::Result result = network_.step(pending_ / steps, heat_, temperature_);
    from_outside_ += result.from_outside;
    converged &= result.converged;
    follow(body.particles());
  }
  if (converged) return;
  body.report.warn(
      "heat_not_converged: the temperatures of an implicit substep did not converge; the heat of "
      "the body is accounted for, but take a smaller time step or a lower conductivity");
}

void HeatEffect::find_environment(const Particles& particles) {
  const SphKernels kernels(blend_.support());
  const Eigen::VectorXd& volumes = blend_.volumes();
  PairSums* device = blend_.pair_sums();
  if (device == nullptr || !device->color_slope(slope_)) sum_slope(particles);
  passes_.setZero(particles.size());
  brings_.setZero(particles.size());
  for (const Obstacle& obstacle : obstacles_) face(obstacle, particles, kernels);
  const Eigen::VectorXd air =
      2.0 * environment_.convection * volumes.cwiseProduct(slope_.colwise().norm().transpose());
  passes_ += air;
  brings_ += environment_.air_temperature * air;
}

void HeatEffect::sum_slope(const Particles& particles) {
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
}

void HeatEffect::face(const Obstacle& obstacle, const Particles& particles,
                      const SphKernels<double>& kernels) {
  const Eigen::VectorXd& volumes = blend_.volumes();
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
        environment_.wall_conductance > 0.0
            ? 2.0 * volumes[i] * facing * environment_.wall_conductance
            : wall_drag(kernels, volumes[i], part_of(i).material.conductivity, distance);
    passes_[i] += through;
    brings_[i] += through * *obstacle.temperature;
  }
}

void HeatEffect::conduct(const Particles& particles) {
  const SphKernels kernels(blend_.support());
  const NeighborLists& lists = blend_.neighbors(particles.x);
  const Eigen::VectorXd& volumes = blend_.volumes();
  const auto part = [this](int i) { return part_numbers_[static_cast<std::size_t>(i)]; };
  lists.for_each_point([&](int rank, int i) {
    double sum = 0.0;
    lists.for_each_neighbor(rank, [&](int o) {
      const double r = (particles.x.col(i) - particles.x.col(o)).norm();
      const double pair = (volumes[i] * volumes[o]) * kernels.viscosity_laplacian(r);
      const double flux = pair / kSphLaplacian * (temperature_[i] - temperature_[o]);
      sum -= conductivities_(part(i), part(o)) * flux;
    });
    rate_[i] = sum;
  });
}

void HeatEffect::exchange(const Particles& particles, double dt) {
  PairSums* device = blend_.pair_sums();
  if (device == nullptr ||
      !device->conduction(temperature_, conductivities_ / kSphLaplacian, rate_)) {
    conduct(particles);
  }
  for (int i = 0; i < particles.size(); ++i) {
    if (passes_[i] == 0.0) continue;
    // dT/dt = −λ (T − T_outside) over the step, so that a large λ = Σ g/(m c) does not overshoot.
    const double decay = dt * passes_[i] / (particles.mass[i] * part_of(i).material.capacity);
    const double mean = -std::expm1(-decay) / decay;
    const double from_outside = mean * (brings_[i] - passes_[i] * temperature_[i]);
    rate_[i] += from_outside;
    from_outside_ += dt * from_outside;
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
       number_parameter("melting_range", "K", "4", 1e-6, 1e4, "from all solid to all liquid"),
       number_parameter("latent_heat", "J/kg", "1e5", 0.0, 1e9, "of melting"),
       // Less, and it vanishes beside the latent heat.
       number_parameter("capacity", "J/(kg K)", "2000", 1e-3, 1e9, "heat per mass and kelvin"),
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
        HeatEffect::Environment around{given.number("initial_temperature"),
                                       given.number("solid_beta"), given.number("air_temperature"),
                                       given.number("convection"),
                                       given.number("wall_conductance")};
        auto* blend = site.body.model->find<BlendedParticles>();
        if (blend == nullptr) throw InputError("effect 'heat' needs a body of particles");
        return std::make_unique<HeatEffect>(site.body, *blend, site.obstacles, material, around);
      }};
}

}  // namespace pliant
