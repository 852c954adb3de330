#pragma once

#include <vector>

#include "pliant/core/effect.h"
#include "pliant/effects/air/air_gas.h"
#include "pliant/effects/air/bubbles.h"
#include "pliant/effects/strain_limit/linear_constraints.h"

namespace pliant {

class ContactEffect;
class WetnessEffect;

/// Air sealed between a wet cloth and what it lies on: bubbles, one for each connected piece of
/// cloth that is lifted, each of constant amount, p V^γ = p_a V_0^γ (Boyle, or adiabatic). The
/// pressure is solved for implicitly with the volume that it makes and the air that leaks through
/// the weave (Darcy) and the edge, so that V -> 0 or V_0 = 0 cannot blow up at any step.
class AirEffect final : public Effect, public Constraint, public LinearConstraintProvider {
 public:
  struct Options {
    double volume = 0.0;  ///< V_0: of the sealed air at atmospheric pressure [m³]
    /// Over which it is let in, evenly; below a step it is there at once [s].
    double fill_time = 0.0;
    AirGas gas;
    double permeability = 0.0;  ///< of the weave: flow per area and pressure [m/(s Pa)]
    double edge_leak = 0.0;     ///< flow per length of lifted edge and pressure [m²/(s Pa)]
    bool seal_breaks = true;    ///< air enters where the cloth's edge is off
    double seal_gap = 0.002;    ///< height of the edge at which the seal breaks [m]
  };
  /// `sealing` are the numbers of the obstacles that it is sealed on.
  AirEffect(const EffectSite& site, std::vector<int> sealing, const Options& options);

  std::string_view name() const override { return "air"; }
  Constraint* constraint() override { return this; }
  void add_reactions(std::vector<Reaction>& reactions) const override;
  double potential_energy(const Body& body) const override;
  void reset(Body& body) override;
  void undo_step() override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;

  void begin_step(const Particles& particles, double dt) override;
  void reset_multipliers() override;
  void relax(const Eigen::VectorXd& mobility, Positions& x) override;
  void add_forces(Forces& f) const override;
  double alternating_projection(const Eigen::VectorXd& mobility, Positions& x) override;
  bool is_collective() const override { return true; }
  void add_rows(const Positions& x, ConstraintRows& rows) override;
  /// Of what holds no air the law does not give the volume: that is found by relaxation.
  bool takes_multipliers() const override;
  bool needs_matrix() const override { return true; }
  bool tells_point_constraints() const override { return false; }
  double work(const Positions& x) const override;
  // What comes at once makes itself room, and pays for that from nothing.
  bool tells_energy() const override { return !makes_room_ || !is_squeezed(); }
  bool is_idle() const override;
  void warm_start() override;
  void add_point_constraints(const Positions& x, PointConstraints& constraints) override;
  void take_multipliers(const PointConstraints& constraints) override;
  double missed_linear_constraints(const Positions& x) override;
  void add_linear_constraints(const Positions& x, LinearConstraints& conditions) override;
  void set_change(int number, double change) override;
  void take_changes() override;
  void report(StepReport& report) const override;
  void after_step(Body& body, double dt) override;

  const std::vector<Bubble>& bubbles() const { return bubbles_.all(); }
  /// Under one of them, where obstacles are now [m³].
  double volume(const Bubble& bubble, const Positions& x) const;
  /// p of the bubble of most vertices, of the last step; of the room where there is none [Pa].
  double pressure() const;
  /// Between all of the cloth and what it is sealed on, where that is now [m³].
  double volume(const Positions& x) const;
  double amount() const;  ///< V_0 of all bubbles, and of air that has none yet [m³]
  bool sealed() const;    ///< no bubble is open

 protected:
  void* offer(const std::type_info& type) override {
    return offer_as<AirEffect, LinearConstraintProvider>(this, type);
  }

 private:
  /// The first relaxation of a bubble in an iteration, along the gradient of where it is.
  void relax_first(const Eigen::VectorXd& mobility, Bubble& bubble, Positions& x);
  /// Another, after its neighbours moved vertices that are its own too. False once it changes
  /// nothing any more.
  bool relax_further(Bubble& bubble, Positions& x);
  /// Changes a bubble's pressure by `delta` [Pa], and moves its vertices, to where its air has its
  /// volume. False where vertices would go too far for that, and it changes less.
  bool adjust_pressure(Bubble& bubble, Positions& x, double& delta) const;
  /// Air that has no volume at all would have no bound of its energy: it counts as in a layer of
  /// kTinyBubbleHeight [m³].
  static double least_volume(const Bubble& bubble);
  void gather(const Positions& x, Bubble& bubble) const;
  /// x becomes where it was moved.
  static void scatter(const Bubble& bubble, Positions& x);
  static void gather_mobility(const Eigen::VectorXd& mobility, Bubble& bubble);
  /// Sets how far water takes each vertex of it back as it rises, with its mobility.
  void gather_held(Bubble& bubble);
  /// Sets how much of its volume is cloth, at `x`.
  void measure_layers(const Positions& x, Bubble& bubble) const;
  double conductance(const Bubble& bubble) const;
  /// What of it is the weave where the cloth is not wet.
  double dry_conductance(const Bubble& bubble) const;
  void add_reactions(const Bubble& bubble, std::vector<Reaction>& reactions) const;
  /// Calls use(bubble) for each that is closed, and for the cloth that lies.
  template <class Use>
  void for_each_sealed(const Use& use);
  void start_filling();
  void let_in(double dt);
  /// Amount of its air after a step of `dt` [s] at its present pressure, what leaked is gone [m³].
  static double left(const Bubble& bubble, double dt);
  /// Whether a bubble has less room than its air needs at the pressure of the room.
  bool is_squeezed() const;
  /// After a step in which air that came at once made itself room: the cloth goes on as it went
  /// before.
  void make_room(Particles& particles);
  double offset() const;
  /// That layers of the cloth keep between them; 0 where nothing keeps them apart [m].
  double layer_thickness() const;

  const Body& body_;
  const Model& model_;
  const std::vector<Obstacle>& obstacles_;
  FootFinder finder_;
  Options options_;
  CoverTriangles triangles_;  // wound so that their normals lead away from what they lie on
  Bubbles bubbles_;
  const WetnessEffect* wetness_ = nullptr;
  const ContactEffect* contact_ = nullptr;  // where water may hold the cloth
  Eigen::VectorXd holds_;  // of all vertices, force by which contact may hold them yet [N]
  double loose_ = 0.0;     // air that has no bubble yet [m³]
  double filled_ = 0.0;    // share of the options' volume that was let in
  // Whether air that came at once has not found its volume yet.
  bool makes_room_ = false;
  bool made_room_ = false;  // in the last step
  bool escapes_ = false;    // in the running step, air that is let in
  double leaked_ = 0.0;     // through cloth that is not wet, since the start [m³]
  double largest_move_;     // of a particle in one relaxation [m]
  double dt_ = 0.0;
  FootPoints foot_points_;     // of all vertices
  std::vector<int> tied_;      // bubbles of the constraints that were asked for last
  std::size_t first_tie_ = 0;  // of these
};

EffectRegistry::Entry air_entry();

}  // namespace pliant
