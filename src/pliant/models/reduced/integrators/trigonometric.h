#pragma once

#include "pliant/math/dense_factors.h"
#include "pliant/models/reduced/integrators/energy_guard.h"
#include "pliant/models/reduced/integrators/integrator.h"

namespace pliant {

struct TrigonometricOptions {
  /// Coordinates with h ω <= exact, at most π, turn by the right angle in every step.
  double exact = 3.14159;
  /// The angle by which faster ones turn in a step [rad].
  double slowed = 1.4;
  /// Largest share of the room below the limit of stability that the stiffening of the body takes.
  double limit = 0.7;
  /// Largest error of the energy in a step, over the energy.
  double tolerance = 0.01;
  /// Largest lack of balance between energy, work and damping, over the energy, before it is made
  /// good.
  double drift = 0.01;
  /// Steps between two looks at the tangent; each step's own force shows most of what grows.
  int watch = 64;
};

/// Trigonometric integrator (Gautschi 1961; Hairer, Lubich and Wanner, "Geometric numerical
/// integration", chapter XIII), modified for what the step cannot show (McLachlan and Stern 2014,
/// "Modified trigonometric integrators"). It is Störmer-Verlet with a diagonal mass M,
///   (M + h D/2) v = p + h/2 (f - R(q)),  q' = q + h v,  p' = p + h (f - D v - ½ R(q) - ½ R(q')),
/// so that it is symplectic and reversible, takes one evaluation of R a step, and rests exactly
/// where R(q) = f. A linear coordinate turns by θ with sin²(θ/2) = (h ω)²/(4 Mᵢ) a step. Hence
///   Mᵢ = (h ω/2)²/sin²(h ω/2)   where h ω <= π: the frequency is exact (below 0.95 π; nearly so up
///                               to π, where nothing would be left between it and instability),
///   Mᵢ = (h ω/2)²/sin²(slowed/2) for faster ones, which a step cannot show: they follow the
///                               others as at rest, and swing slowly. Four such turns, 1.4 each,
///                               are less than a whole one, where the terms of the energy of third
///                               and fourth degree would resonate with the step.
/// Momenta are kept in the units 1/√(Mᵢ - (h ω)²/4), in which ½ p² + ½ λ q² of a small motion is
/// constant and, where the frequency is exact, p is the velocity. Dᵢ = 2 Mᵢ/h tanh(h D/2) makes
/// small motions die as they should.
///
/// The energy ½ p² + V changes, but for work, damping and what swings back, by the error of the
/// trapezoidal rule along the step,
///   T = V(q') - V(q) - ½ (R(q) + R(q'))·(q' - q),
/// which is 0 where V is quadratic and is measured in every step. A step where |T|, or the change
/// of energy that work and damping do not explain, exceeds `tolerance` of the energy, or the
/// nonlinear part of Δq·ΔR exceeds `limit` of Δq·(4 M/h² - Λ) Δq, is made again in 2, 4, ... 64
/// substeps, each with the M for its own length (figure "substeps"); in these, coordinates are
/// exact where the substep's h ω <= slowed or the step's is <= π. Where that is not enough M grows
/// ("resplit"). What remains is held by EnergyGuard ("energy_held"). In gentle motion nothing of
/// that happens.
class Trigonometric final : public Integrator {
 public:
  explicit Trigonometric(const TrigonometricOptions& options)
      : options_(options), guard_(options.drift) {}
  std::string_view name() const override { return "trigonometric"; }
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;
  static SolverRegistry::Entry entry();

 private:
  /// q, p in units of M, and R and V there.
  struct State {
    Eigen::VectorXd q, p, r;
    double elastic = 0.0;
  };
  /// Of all substeps of a step.
  struct Trial {
    double worst = 0.0;       // largest error of the energy in a substep, over the energy
    double stiffest = 0.0;    // largest share of the room below the limit of stability
    double dissipated = 0.0;  // [J]
  };
  void prepare_step(const ReducedSystem& system, double h) override;
  void advance(ReducedSystem& system, double h, StepReport& report) override;
  /// Masses, units and the response to forces of a step in so many substeps.
  void use_substeps(int substeps);
  /// Coordinates that turn by more in a substep are slowed [rad].
  double exact_angle() const;
  double mass_of(double angle) const;
  /// Changes to so many substeps, more than before, and state_ to their units.
  void divide(int substeps);
  void set_response();
  /// Both end early, with false, where a substep does not pass.
  bool make_substep(const ReducedSystem& system);
  bool make_substeps(const ReducedSystem& system);
  /// Makes the step in more and more substeps until it passes; number of substeps that were tried.
  int make_step(const ReducedSystem& system, StepReport& report);
  void hold_energy(ReducedSystem& system, StepReport& report);
  /// Fewer substeps after some steps that had room for that.
  void relax_substeps();
  /// The least number of substeps, at most 2 kMostSubsteps, that the tangent at q allows.
  int substeps_for(const ReducedSystem& system, const Eigen::VectorXd& q);
  /// Makes M larger if the most substeps are not enough at q; whether it did.
  bool resplit(const ReducedSystem& system, const Eigen::VectorXd& q);

  TrigonometricOptions options_;
  double h_ = 0.0;
  Eigen::VectorXd omega_, damping_;
  bool is_damped_ = false;
  int substeps_ = 1;
  double least_mass_ = 1.0;  // grows where the most substeps are not enough
  // Of a substep.
  double substep_ = 0.0;  // its length [s]
  Eigen::Array<bool, Eigen::Dynamic, 1> slowed_, was_slowed_;
  Eigen::VectorXd mass_;    // M
  Eigen::VectorXd unit_;    // of the momenta
  Eigen::VectorXd drift_;   // 1/(M + h D/2)
  Eigen::VectorXd drag_;    // h D
  Eigen::VectorXd bend_;    // h² λ
  Eigen::VectorXd room_;    // 4 M - h² λ
  int least_substeps_ = 1;  // that the tangent asks for
  int calm_ = 0;            // steps with room for fewer substeps
  int until_watch_ = 0;     // steps
  EnergyGuard guard_;

  State state_, before_;
  double kinetic_ = 0.0;  // of state_, while substeps are made [J]
  Trial trial_;
  Eigen::VectorXd known_q_, w_, v_, embedded_;
  Eigen::MatrixXd tangent_, margin_;
  DenseCholesky factor_;
  QuarticPotential::Workspace space_;
};

}  // namespace pliant
