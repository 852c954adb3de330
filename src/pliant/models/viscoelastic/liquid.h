#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/models/viscoelastic/liquid_device.h"
#include "pliant/models/viscoelastic/liquid_sums.h"
#include "pliant/models/viscoelastic/liquid_walls.h"

namespace pliant {

struct StepReport;

/// What flows.
struct LiquidMaterial {
  double density = 1000.0;   ///< at rest [kg/m³]
  double sound_speed = 5.0;  ///< c [m/s]
  double viscosity = 0.1;    ///< μ [Pa s]

  double bulk() const { return sound_speed * sound_speed * density; }  ///< modulus c² ρ⁰ [Pa]
};

/// The forces of a weakly compressible liquid on its particles (Müller et al. 2003), with ψ the
/// space that the particles' rest volumes V fill, 1 at rest, and density ρ = ρ⁰ ψ:
///   ψᵢ = Σⱼ Vⱼ W(xᵢ − xⱼ) − const + walls,   pᵢ = c² (ρᵢ − ρ⁰), none below 0,
///   fᵢ = Σⱼ Vᵢ Vⱼ w [ −(pᵢ/ψᵢ² + pⱼ/ψⱼ²) ∇W + μ (vⱼ − vᵢ) ∇²W ].
/// There the paper takes the density from the kernel poly6 and pressure forces from spiky. These
/// are no gradient of any energy, and a stiff liquid heats itself up by them
/// (docs/viscoelastic.md); with spiky for both and walls that are a potential, energy is kept to
/// the integrator's order. Volumes instead of masses let liquids of different densities meet. A
/// pair counts by w: the larger `beta` of two particles of one part, 1 for parts that meet. So
/// forces between particles are equal and opposite to the bit, and a solid is pushed by the liquid
/// it lies in.
class Liquid {
 public:
  /// Adds particles of rest `volumes` [m³] as a part of its own.
  void add_part(const Eigen::VectorXd& volumes, const LiquidMaterial& material);

  int size() const { return static_cast<int>(volumes_.size()); }
  /// H [m]: twice the largest particle spacing.
  double support() const { return support_; }
  const Eigen::VectorXd& volumes() const { return volumes_; }
  const std::vector<int>& parts() const { return parts_; }
  const LiquidMaterial& material(int particle) const {
    return materials_[static_cast<std::size_t>(parts_[static_cast<std::size_t>(particle)])];
  }
  /// Largest step that is stable where particles move at `speed` [m/s, s], by the CFL and the
  /// viscous condition.
  double stable_step(double speed) const;
  /// The fastest speed [m/s] at which a step of `dt` is stable by the CFL condition; negative where
  /// none is. And the longest step by the viscous one [s].
  double stable_speed(double dt) const;
  double viscous_step() const;
  /// Whether any pair can feel a force at all.
  bool acts(const Eigen::VectorXd& beta) const;

  /// All pairs within the support, and some a little beyond it, at `x`: kept while nothing moved
  /// far.
  const NeighborLists& neighbors(const Positions& x);
  /// ψ, without walls, of each particle.
  Eigen::VectorXd filling(const Positions& x) const;
  /// Adds the forces at the particles' present positions and velocities. `walls` may be null.
  void add_forces(const Particles& particles, const Eigen::VectorXd& beta, LiquidWalls* walls,
                  Forces& f, StepReport& report);
  /// What viscosity between particles took of each one's motion in the step of `dt` that began at
  /// x_start and v_start and ended with v [s, J]: the work of the forces that add_forces() added
  /// then, over all pairs, half of a pair's to either. For `beta` of then.
  Eigen::VectorXd viscous_losses(const Particles& particles, const Eigen::VectorXd& beta,
                                 double dt);
  /// Computes the forces between particles there from now on; null: itself. Where a device fails,
  /// it warns once and goes on by itself.
  void set_device(std::unique_ptr<LiquidDevice> device) { device_ = std::move(device); }
  bool has_device() const { return device_ != nullptr; }
  LiquidDevice* device() { return device_.get(); }
  LiquidState state(const Particles& particles, const Eigen::VectorXd& beta) const {
    return {particles, beta, volumes_, parts_, materials_, support_};
  }
  /// It is given up; the next add_forces() warns.
  void device_failed(const std::string& reason);
  /// ψ of each particle at the last add_forces().
  const Eigen::VectorXd& last_filling() const { return psi_; }
  /// Of the particles that are liquid, the share which then was compressed by a quarter or more.
  double compressed_share(const Eigen::VectorXd& beta) const;

  /// Where the lists were made: with them, sums go on in the same order.
  const Positions& listed_positions() const { return listed_; }
  void list_at(const Positions& x);

 private:
  struct Pass;
  double fastest_sound() const;  ///< of its materials [m/s]
  void gather(const Positions& x, const Eigen::Matrix3Xd& v, const Eigen::VectorXd& beta);
  void fill(const LiquidWalls* walls);
  void push(Forces& f);
  // False where the device failed.
  bool add_device_forces(const Particles& particles, const Eigen::VectorXd& beta,
                         const LiquidWalls* walls, Forces& f, StepReport& report);
  bool device_viscous_losses(const Particles& particles, const Eigen::VectorXd& beta, double dt,
                             Eigen::VectorXd& losses);

  Eigen::VectorXd volumes_;
  std::vector<int> parts_;  // of each particle
  std::vector<LiquidMaterial> materials_;
  double support_ = 1.0;
  NeighborLists lists_;
  Positions listed_;

  // By rank of the lists.
  std::vector<LiquidParticle> ranked_;
  Eigen::VectorXd sums_;
  Eigen::Matrix3Xd pushes_;
  Eigen::Matrix4Xd later_;  // velocities, of viscous_losses()
  Eigen::VectorXd psi_;     // by particle
  std::unique_ptr<LiquidDevice> device_;
  Eigen::VectorXf wall_filling_;  // by particle, for the device
  std::string device_failure_;    // not told yet
};

}  // namespace pliant
