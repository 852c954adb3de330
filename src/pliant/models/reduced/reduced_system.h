#pragma once

#include <Eigen/Core>
#include <limits>

#include "pliant/core/step/step_report.h"
#include "pliant/core/system/system.h"
#include "pliant/models/reduced/quartic_potential.h"

namespace pliant {

/// D = α I + β K(0): Rayleigh damping with the stiffness at rest, which takes energy at every q;
/// K(q) of a compressed body would give some.
struct RayleighDamping {
  double mass = 0.0;       ///< α >= 0 [1/s]
  double stiffness = 0.0;  ///< β >= 0 [s]
};

/// What a unit force on each coordinate, constant during a step, has done by the step's end to q
/// and to p, for small motion.
struct StepResponse {
  Eigen::VectorXd q;  ///< r [s²], >= 0
  Eigen::VectorXd p;  ///< r [s]
};

/// q'' + D q' + R(q) = f, R = ∇V; masses are 1, so that the momentum p is q'.
class ReducedSystem : public System {
 public:
  explicit ReducedSystem(QuarticPotential reduced_potential, RayleighDamping rayleigh = {});

  QuarticPotential potential;
  RayleighDamping damping;
  Eigen::VectorXd q;      ///< r [kg^½ m]
  Eigen::VectorXd p;      ///< r [kg^½ m/s]
  Eigen::VectorXd force;  ///< f = Uᵀ f_ext, constant during a step; its value at the step's middle

  /// V(q) at the end of an integrator's step, where that knows it [J]; else NaN.
  double known_elastic = std::numeric_limits<double>::quiet_NaN();

  /// What an integrator will answer forces with, once it is prepared.
  virtual void take_response(const StepResponse& /*response*/) {}
  /// Called by integrators before and after each of their steps of h seconds.
  virtual void begin_step(double /*h*/) {}
  virtual void end_step(double /*h*/, const StepResponse& /*response*/, StepReport& /*report*/) {}

  /// Diagonal of D [1/s].
  Eigen::VectorXd damping_rates() const;
  double kinetic_energy() const override { return 0.5 * p.squaredNorm(); }
  double elastic_energy() const override { return potential.energy(q, space_); }
  /// Σ ½ pᵢ² + ½ λᵢ qᵢ² of the coordinates from `first` on [J].
  double linear_energy(int first) const;

 private:
  mutable QuarticPotential::Workspace space_;
};

}  // namespace pliant
