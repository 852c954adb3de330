#pragma once

#include "pliant/core/effect.h"
#include "pliant/effects/strain_limit/linear_constraints.h"
#include "pliant/effects/strain_limit/yarn_limits.h"

namespace pliant {

/// Cloth whose yarns stretch no further than a limit, whatever solver moves it and however it is
/// held: the limits take part in the iterations, and what these leave is taken off afterwards.
class ClothStrainLimit final : public Effect, public Constraint {
 public:
  /// `max` >= 1; `system` outlives this. Throws InputError for cloth without yarns that stretch.
  ClothStrainLimit(const ProjectiveSystem& system, double max);
  std::string_view name() const override { return "strain_limit"; }
  Constraint* constraint() override { return this; }
  /// Reports `largest_strain`, that of warp and weft, and warns where it is far above the limit.
  void after_step(Body& body, double dt) override;
  void reset(Body& body) override;

  void begin_step(const Particles& particles, double dt) override;
  void reset_multipliers() override { limits_.reset_multipliers(); }
  void relax(const Eigen::VectorXd& mobility, Positions& x) override;
  void add_forces(Forces& f) const override { limits_.add_forces(f); }
  void add_rows(const Positions& x, ConstraintRows& rows) override { limits_.add_rows(x, rows); }
  /// Tethers reach over all of the cloth.
  bool is_collective() const override { return true; }
  // A limit that is not met where the step begins gives what it takes to meet it.
  bool tells_energy() const override { return false; }
  int active() const override { return limits_.active(); }
  void final_projection(const Eigen::VectorXd& mobility, Positions& x) override;

  bool needs_alternating_projection() const override { return true; }
  double alternating_projection(const Eigen::VectorXd& mobility, Positions& x) override;

  const YarnLimits& limits() const { return limits_; }

 private:
  const ProjectiveSystem& system_;
  double max_;
  YarnLimits limits_;
  Eigen::VectorXd free_mobility_;  // h² / m [m/N]
  std::vector<HeldVertex> held_;   // by attachments, at present
  std::vector<LinearConstraintProvider*> providers_;
};

}  // namespace pliant
