#pragma once

#include <vector>

#include "pliant/core/body/blended_particles.h"
#include "pliant/core/effect.h"
#include "pliant/effects/particles/heat_material.h"
#include "pliant/effects/particles/heat_network.h"

namespace pliant {

template <typename T>
class SphKernels;

/// Heat in a body of particles, and melting by it. Each particle holds the enthalpy H [J]:
///   dHᵢ/dt = Σⱼ Vᵢ Vⱼ k (Tⱼ − Tᵢ) ∇²W + walls + air,
/// with the Laplacian of the viscosity kernel. What one gives another takes, so that heat is kept
/// to round-off. Its liquid share becomes the particle's beta. Each part of a body may be of a
/// material of its own; between two, k is the harmonic mean, with which the flux is the same on
/// either side of their border (Cleary and Monaghan 1999).
///
/// An obstacle that has a temperature conducts as if the body went on within it, or through its
/// surface with a given conductance. What faces neither particles nor obstacles is cooled by the
/// air. The elastic energy that particles lose as they melt, and as their shape creeps, becomes
/// their heat, and so does what viscosity, damping and friction on obstacles take of their motion:
/// of friction half, where the obstacle has a temperature.
///
/// Steps are explicit while 200 of them are enough for a step of the body, and else implicit ones
/// of a HeatNetwork, 16 at least and 10 ms long at most, which a warning says: no material makes a
/// step endless or loses heat.
class HeatEffect final : public Effect {
 public:
  struct Environment {
    double initial_temperature = 293.15;  ///< of the body [K]
    double solid_beta = 0.0;              ///< of what is not melted
    double air_temperature = 293.15;      ///< [K]
    double convection = 10.0;             ///< to the air [W/(m² K)]
    double wall_conductance = 0.0;        ///< of an obstacle's surface [W/(m² K)]; 0: it has none
  };
  /// Of a body whose model is one of BlendedParticles; what its parts say for themselves takes the
  /// place of `material` and of `environment`.
  HeatEffect(Body& body, BlendedParticles& blend, const std::vector<Obstacle>& obstacles,
             const HeatMaterial& material, const Environment& environment);

  std::string_view name() const override { return "heat"; }
  void after_step(Body& body, double dt) override;
  bool remembers_steps() const override { return true; }
  void reset(Body& body) override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;
  std::vector<SettableField> settable_fields() override;

  const Eigen::VectorXd& temperatures() const { return temperature_; }  ///< [K]
  void set_temperature(int particle, double temperature);
  double total_heat() const { return heat_.sum(); }  ///< [J]
  /// What walls and air gave since the start, less what they took [J].
  double heat_from_outside() const { return from_outside_; }
  /// What melting and creep took of the body's elastic energy since the start [J]: it warms the
  /// particles that held it.
  double heat_from_strain() const { return from_strain_; }
  /// What viscosity, `damping`, `xsph` and `friction` took of the body's motion since the start
  /// [J].
  double heat_from_motion() const { return from_motion_; }
  /// Largest step of the conduction that is stable [s].
  double stable_step() const;

 private:
  struct Part {
    int first, count;
    HeatMaterial material;
    double initial_temperature, solid_beta;
  };
  const Part& part_of(int particle) const {
    return parts_[static_cast<std::size_t>(part_numbers_[static_cast<std::size_t>(particle)])];
  }
  void add_part(const BlendedParticles::Part& part, const HeatMaterial& material);
  void start(const Particles& particles);
  void take(const Eigen::VectorXd& losses, double& sum);
  void find_environment(const Particles& particles);
  /// What of the environment of particles an obstacle fills, and what heat it passes on.
  void face(const Obstacle& obstacle, const Particles& particles,
            const SphKernels<double>& kernels);
  // Sums over neighbours, where no device makes them.
  void sum_slope(const Particles& particles);
  void conduct(const Particles& particles);
  void exchange(const Particles& particles, double dt);
  void fill_network(const Particles& particles);
  void exchange_implicitly(double explicit_steps, Body& body);
  void follow(const Particles& particles);
  void set_beta(int particle);

  const Body& body_;
  BlendedParticles& blend_;
  const std::vector<Obstacle>& obstacles_;
  Environment environment_;
  std::vector<Part> parts_;
  std::vector<int> part_numbers_;              // of each particle
  Eigen::MatrixXd conductivities_;             // between the parts [W/(m K)]
  Eigen::VectorXd heat_, temperature_, rate_;  // [J], [K], [W]
  // From walls and air to each particle: Σ g and Σ g T of their conductances g [W/K], [W].
  Eigen::VectorXd passes_, brings_;
  Eigen::Matrix3Xd slope_;     // of the colour field [1/m]
  HeatNetwork network_;        // of implicit steps
  double pending_ = 0.0;       // time that heat is behind [s]
  double from_outside_ = 0.0;  // [J]
  double from_strain_ = 0.0;   // [J]
  double from_motion_ = 0.0;   // [J]
};

EffectRegistry::Entry heat_entry();

}  // namespace pliant
