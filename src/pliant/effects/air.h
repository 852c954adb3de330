#pragma once

#include <vector>

#include "pliant/core/effect.h"
#include "pliant/effects/column_volume.h"

namespace pliant {

/// Air sealed between a wet cloth and a plane: one bubble of constant amount, p V = p_a V_0
/// (Boyle). The pressure is solved for implicitly with the volume that it makes and the air that
/// leaks through the weave (Darcy), so that V -> 0 or V_0 = 0 cannot blow up at any step.
class AirEffect final : public Effect, public Coupling {
 public:
  struct Options {
    double volume = 0.0;           ///< V_0: of the sealed air at atmospheric pressure [m³]
    double fill_time = 0.0;        ///< over which it is let in, evenly; 0: it is there at once [s]
    double atmosphere = 101325.0;  ///< p_a [Pa]
    double permeability = 0.0;     ///< of the weave: flow per area and pressure [m/(s Pa)]
    bool seal_breaks = true;       ///< air enters while the cloth's edge is off the plane
    double seal_gap = 0.002;       ///< height of the edge at which the seal breaks [m]
  };
  /// `plane` is the number of an obstacle with the shape plane.
  AirEffect(const EffectSite& site, int plane, const Options& options);

  std::string_view name() const override { return "air"; }
  Coupling* coupling() override { return this; }
  void add_reactions(std::vector<Reaction>& reactions) const override;
  double potential_energy(const Body& body) const override;
  void reset(Body& body) override;
  void save(SavedNumbers& numbers) const override;
  void load(SavedNumbers& numbers) override;

  void begin_step(const Particles& particles, double dt) override;
  void reset_multipliers() override { gauge_ = 0.0; }
  void relax(const Eigen::VectorXd& mobility, Positions& x) override;
  void add_forces(Forces& f) const override;
  bool is_collective() const override { return true; }
  void add_rows(const Positions& x, CouplingRows& rows) override;
  void report(StepReport& report) const override;
  void after_step(Body& body, double dt) override;

  double pressure() const { return options_.atmosphere + gauge_; }  ///< p, of the last step [Pa]
  /// Between cloth and plane where the plane is now [m³].
  double volume(const Positions& x) const { return column_volume(triangles_, x, ground()); }
  double amount() const { return amount_; }  ///< V_0 [m³]
  bool sealed() const { return sealed_; }

 private:
  /// Positions when the gauge pressure rises by `delta`, into moved_.
  void move(double delta, const Eigen::VectorXd& mobility, const Positions& x);
  /// As volume(), where the plane is in the running step; allocates nothing. Sets heights_.
  double enclosed_volume(const Positions& x);
  /// dV/dp at moved_ by the particles that the ground does not stop [m³/Pa].
  double volume_slope(const Eigen::VectorXd& mobility) const;
  double solve_pressure_change(const Eigen::VectorXd& mobility, const Positions& x);
  /// Largest pressure change that moves no particle further than a share of the mesh width.
  double largest_change(const Eigen::VectorXd& mobility) const;
  void start_filling();
  void let_in(double dt);
  Ground ground() const;
  bool edge_is_lifted(const Positions& x) const;

  const Body& body_;
  const Model& model_;
  const Eigen::Matrix3Xi& triangles_;
  const std::vector<Obstacle>& obstacles_;
  int plane_;
  Options options_;
  std::vector<int> edge_;  // particles of the cloth's boundary
  Ground ground_;          // of the running step
  double amount_ = 0.0;    // V_0 [m³]
  double filled_ = 0.0;    // share of the options' volume that was let in
  bool sealed_ = true;
  double gauge_ = 0.0;   // p - p_a, the multiplier [Pa]
  double conductance_;   // permeability times area [m³/(s Pa)]
  double largest_move_;  // of a particle in one relaxation [m]
  double dt_ = 0.0;
  bool limited_ = false;  // the last relaxation met largest_move_
  Eigen::Matrix3Xd gradient_;
  Eigen::VectorXd heights_;  // where the volume was last taken [m]
  Positions moved_;          // what a pressure change makes of the positions
};

EffectRegistry::Entry air_entry();

}  // namespace pliant
