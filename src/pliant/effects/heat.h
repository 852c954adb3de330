#pragma once

#include <vector>

#include "pliant/core/blended_particles.h"
#include "pliant/core/effect.h"
#include "pliant/effects/heat_material.h"

namespace pliant {

/// Heat in a body of particles, and melting by it. Each particle holds the enthalpy H [J]:
///   dHᵢ/dt = Σⱼ Vᵢ Vⱼ k (Tⱼ − Tᵢ) ∇²W + walls + air,
/// with the Laplacian of the viscosity kernel. What one gives another takes, so that heat is kept
/// to round-off. Its liquid share becomes the particle's beta.
///
/// An obstacle that has a temperature conducts as if the body went on within it, or through its
/// surface with a given conductance. What faces neither particles nor obstacles is cooled by the
/// air.
class HeatEffect final : public Effect {
 public:
  struct Surroundings {
    double initial_temperature = 293.15;  ///< of the body [K]
    double solid_beta = 0.0;              ///< of what is not melted
    double air_temperature = 293.15;      ///< [K]
    double convection = 10.0;             ///< to the air [W/(m² K)]
    double wall_conductance = 0.0;        ///< of an obstacle's surface [W/(m² K)]; 0: it has none
  };
  /// Of a body whose model is one of BlendedParticles.
  HeatEffect(Body& body, BlendedParticles& blend, const std::vector<Obstacle>& obstacles,
             const HeatMaterial& material, const Surroundings& surroundings);

  std::string_view name() const override { return "heat"; }
  void after_step(Body& body, double dt) override;
  void reset(Body& body) override;
  void save(SavedNumbers& numbers) const override;
  void load(SavedNumbers& numbers) override;
  std::vector<SettableField> settable_fields() override;

  const Eigen::VectorXd& temperatures() const { return temperature_; }  ///< [K]
  void set_temperature(int particle, double temperature);
  double total_heat() const { return heat_.sum(); }  ///< [J]
  /// Largest step of the conduction that is stable [s].
  double stable_step() const;

 private:
  struct Wall {
    int particle;
    double flux_per_kelvin;  // [W/K]
    double temperature;      // [K]
  };

  void start(const Particles& particles);
  void find_surroundings(const Particles& particles);
  void exchange(const Particles& particles, double dt);
  void follow(const Particles& particles);

  const Body& body_;
  BlendedParticles& blend_;
  const std::vector<Obstacle>& obstacles_;
  HeatMaterial material_;
  Surroundings surroundings_;
  Eigen::VectorXd heat_, temperature_, rate_;  // [J], [K], [W]
  Eigen::VectorXd air_;                        // to the air [W/K]
  Eigen::Matrix3Xd slope_;                     // of the colour field [1/m]
  std::vector<Wall> walls_;
  double pending_ = 0.0;  // time that heat is behind [s]
};

EffectRegistry::Entry heat_entry();

}  // namespace pliant
