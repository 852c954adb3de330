#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/body/blended_particles.h"
#include "pliant/core/body/model.h"
#include "pliant/models/viscoelastic/blended_system.h"
#include "pliant/models/viscoelastic/liquid_pair_sums.h"
#include "pliant/models/viscoelastic/particle_surface.h"

namespace pliant {

class Solver;

/// One body from rigid to liquid: the same particles flow by SPH and hold together by shape
/// matching over overlapping clusters, blended for each of them by beta. A step of the solver moves
/// them by
///   v = v₀ + h [g + beta f_fluid/m + (1 − beta) f_solid/m],
/// the solid part implicitly, so that any of the family's solvers serves; the liquid's forces are
/// explicit, and steps are taken in substeps where they need shorter ones.
class ViscoelasticModel final : public Model, public BlendedParticles {
 public:
  struct Material {
    LiquidMaterial liquid;
    SolidMaterial solid;  ///< a radius of 0: 2.1 particle spacings
    double beta = 0.0;    ///< 0 solid to 1 liquid
    bool oriented = false;
    TurnBlend turn_blend = TurnBlend::kMoments;  ///< of oriented particles
    int surface_detail = 2;                      ///< marching cubes along the kernel's support
    bool anisotropic_surface = false;            ///< kernels that follow it
    int max_substeps = 1000;                     ///< of a step
    HeatProperties heat = {};                    ///< of its own
  };

  /// `geometry` needs interior points. Throws InputError for a material out of range.
  ViscoelasticModel(const BodyGeometry& geometry, const Material& material);

  std::string_view name() const override { return "viscoelastic"; }
  BlendedSystem& system() override { return system_; }
  const BlendedSystem& system() const override { return system_; }

  const Eigen::Matrix3Xi& surface_triangles() const override;
  bool surface_changes() const override { return true; }
  int surface_vertices() const override;
  void surface_positions(Eigen::Ref<Eigen::Matrix3Xd> positions) const override;
  Eigen::VectorXd on_surface(const Eigen::VectorXd& field) const override;
  Eigen::Matrix3Xf particle_colors() const override;
  Eigen::Matrix3Xf surface_colors() const override;
  const Eigen::VectorXd& particle_areas() const override { return areas_; }
  /// `beta`; `density` [kg/m³], of the kernel's sum; `clusters` that hold a particle; what effects
  /// show.
  std::map<std::string, Eigen::VectorXd> point_fields() const override;
  std::vector<SettableField> settable_fields() override;
  bool join(Model& other) override;
  void place(const Eigen::Isometry3d& world_from_body) override;
  bool always_joins() const override { return true; }

  bool acts_around_steps() const override { return true; }
  bool needs_first_order() const override;
  StepPlan plan_step(double dt, StepReport& report) override;
  void before_solver(Body& body, const std::vector<Obstacle>& obstacles, double dt) override;
  void after_solver(Body& body, double dt) override;
  void add_reactions(std::vector<Reaction>& reactions) const override;
  /// What obstacles did to its liquid in the last part of a step.
  std::vector<LiquidWalls::Push> wall_pushes() const;
  bool system_varies() const override { return true; }
  bool join_resident_run(ResidentRun& run) const override;
  void after_resident_run(const ResidentRun& run, int steps) override;

  const Eigen::VectorXd& beta() const override { return system_.beta; }
  void set_beta(int particle, double beta) override { system_.beta[particle] = beta; }
  std::vector<BlendedParticles::Part> blended_parts() const override;
  bool are_bound(int i, int j) const override { return system_.solid().are_bound(i, j); }
  void creep(const Positions& x, double yield, double share) override {
    system_.solid().creep(x, yield, share);
  }
  void keep_losses() override { system_.keep_losses(); }
  bool keeps_losses() const override { return system_.keeps_losses(); }
  Eigen::VectorXd take_losses() override { return system_.solid().take_losses(); }
  void note_motion_losses(const Eigen::VectorXd& losses) override {
    system_.note_motion_losses(losses);
  }
  Eigen::VectorXd take_motion_losses() override { return system_.take_motion_losses(); }
  const Eigen::VectorXd& volumes() const override { return system_.liquid.volumes(); }
  const Eigen::VectorXd* ball_volumes() const override { return &volumes(); }
  double support() const override { return system_.liquid.support(); }
  const NeighborLists& neighbors(const Positions& x) override {
    return system_.liquid.neighbors(x);
  }
  PairSums* pair_sums() override { return system_.liquid.has_device() ? &pair_sums_ : nullptr; }
  void show_field(const std::string& name, const Eigen::VectorXd* values) override;

 protected:
  void* offer(const std::type_info& type) override {
    return offer_as<ViscoelasticModel, BlendedParticles>(this, type);
  }

 private:
  struct Part {
    int first, count;
    Material material;
    Eigen::Vector3f color;
    mutable ParticleSurface surface;
  };
  void add_part(const Positions& x, const Eigen::VectorXd& masses, const Eigen::VectorXd& volumes,
                const Material& material);
  int substeps_of_step(double dt) const;
  /// Why the `step`th step, of that many substeps, cannot be; empty where it can.
  std::string why_no_step(double dt, int substeps, std::uint64_t step) const;
  /// How many steps end before clusters follow beta, at most `most`.
  int steps_unfollowed(double dt, int most) const;
  void keep_momentum(double dt);
  void keep_momentum(const Part& part, double dt);
  /// What viscosity took of the motion in a substep, for what makes heat of it.
  void note_viscous_losses(double dt);
  /// The liquid and the surface go where the solver's iterations do.
  void follow_backend(const Solver& solver, StepReport& report);
  /// Warns where a device failed to make one.
  void tell_of_surfaces(StepReport& report);
  /// Whether the constraints that act push particles against each other alone; sums these forces
  /// and those of other bodies.
  bool constraints_are_inner();
  /// Makes the surface anew where particles moved.
  void refresh_surface() const;
  Eigen::Vector3f color_of(const Part& part) const;

  BlendedSystem system_;
  LiquidPairSums pair_sums_{system_};
  std::vector<Part> parts_;
  Eigen::VectorXd areas_, initial_beta_;
  std::vector<std::pair<std::string, const Eigen::VectorXd*>> shown_;
  // That constraints tell of, between particles and of other bodies, and those of one constraint
  // [N].
  Forces inner_, constraint_forces_;
  bool pushes_walls_ = false;  // in the last part of a step
  bool is_on_gpu_ = false;     // what the solver last did
  mutable Eigen::Matrix3Xi triangles_;
};

ModelRegistry::Entry viscoelastic_entry();

}  // namespace pliant
