#pragma once

#include <Eigen/Cholesky>

#include "pliant/models/reduced/integrators/energy_guard.h"
#include "pliant/models/reduced/integrators/integrator.h"

namespace pliant {

struct ImexOptions {
  /// Coordinates with h ω >= split are in the implicit part.
  double split = 1.0;
  /// Aᵢ = stiffening λᵢ of these; >= 1.
  double stiffening = 8.0;
  /// Largest h ω of a step's own motion, at most 2, where it becomes unstable.
  double limit = 1.3;
  /// Largest error of the energy in a step, over the energy.
  double tolerance = 0.05;
  /// Largest sum of these errors, over the energy, before it is taken back.
  double drift = 0.05;
  /// Steps between two looks at the tangent; each step's own force shows most of what grows.
  int watch = 64;
};

/// Implicit-explicit variational integrator with a true split of the potential (Stern and Grinspun
/// 2009, "Implicit-explicit variational integration of highly oscillatory problems"):
///   V = ½ qᵀ A q + (V - ½ qᵀ A q),
/// the first part by the midpoint rule, in closed form since it is linear, the second by the
/// trapezoidal rule. What A does is to the mass alone, M = I + h²/4 A, which is diagonal:
///   (M + h D/2) v = p + h/2 (f - R(q)),  q' = q + h v,  p' = p + h (f - D v - ½ R(q) - ½ R(q')).
/// This is Störmer-Verlet for that mass: one evaluation of R a step, no iteration, stable about a
/// state where h² K(q) < 4 M, whatever the frequencies in A. With Aᵢ = s λᵢ fast coordinates turn
/// by h ω = 2/√s at most. At s = 1, 2, 3 that is a half, a quarter, a third of a turn, where the
/// cubic and quartic terms of V resonate with the step; so s = 8. Momenta are kept in units in
/// which ½ p² + ½ λ q² of a small motion is constant, that is times 1/√(1 + h² (A - λ)/4).
///
/// But for work and damping, the energy ½ p M⁻¹ p + V - h²/8 R M⁻¹ R changes by exactly the error
/// of the trapezoidal rule along the step,
///   T = V(q') - V(q) - ½ (R(q) + R(q'))·(q' - q),
/// which is 0 where V is quadratic and is measured in every step. A step where |T| exceeds
/// `tolerance` of the energy, or Δq·ΔR exceeds limit² Δq·M Δq/h², is made again in 2, 4, 8 or 16
/// parts with the same M ("parts"); where that is not enough M grows ("resplit"). What remains is
/// held by EnergyGuard ("energy_held"). In gentle motion nothing of that happens, and the method is
/// symplectic, reversible, and of second order.
class Imex final : public Integrator {
 public:
  explicit Imex(const ImexOptions& options) : options_(options), guard_(options.drift) {}
  std::string_view name() const override { return "imex"; }
  /// Diagonal of A [1/s²].
  const Eigen::VectorXd& implicit_stiffness() const { return a_; }
  void save(SavedNumbers& numbers) const override;
  void load(SavedNumbers& numbers) override;
  static SolverRegistry::Entry entry();

 private:
  /// q, p in units of M, and R and V there.
  struct State {
    Eigen::VectorXd q, p, r;
    double elastic = 0.0;
  };
  /// Of all parts of a step.
  struct Trial {
    double error = 0.0;       // sum of T [J]
    double worst = 0.0;       // largest |T| over the energy
    double stiffest = 0.0;    // largest (h ω)² of a part's motion
    double dissipated = 0.0;  // [J]
  };
  void prepare_step(const ReducedSystem& system, double h) override;
  void advance(ReducedSystem& system, double h, StepReport& report) override;
  void set_masses();
  void use_parts(int parts);
  /// Both end early, with false, where a part does not pass.
  bool make_part(const ReducedSystem& system);
  bool make_parts(const ReducedSystem& system);
  /// Makes the step in more and more parts until it passes; number of parts that were tried.
  int make_step(const ReducedSystem& system, StepReport& report);
  void hold_energy(ReducedSystem& system, StepReport& report);
  /// Fewer parts after some steps that had room for that.
  void relax_parts();
  /// The least number of parts, at most 2 kMostParts, that the tangent at q allows.
  int parts_for(const ReducedSystem& system, const Eigen::VectorXd& q);
  /// Makes M larger if the most parts are not enough at q; whether it did.
  bool resplit(const ReducedSystem& system, const Eigen::VectorXd& q);

  ImexOptions options_;
  double h_ = 0.0;
  Eigen::VectorXd lambda_, damping_;
  bool is_damped_ = false;
  Eigen::VectorXd a_, mass_;
  Eigen::VectorXd unit_;   // of the momenta
  Eigen::VectorXd drift_;  // 1/(M + h D/2) of a part
  int parts_ = 1;
  int least_parts_ = 1;  // that the tangent asks for
  int calm_ = 0;         // steps with room for fewer parts
  int until_watch_ = 0;  // steps
  EnergyGuard guard_;

  State state_, before_;
  Trial trial_;
  Eigen::VectorXd known_q_, w_, v_;
  Eigen::MatrixXd tangent_, margin_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
  QuarticPotential::Workspace space_;
};

}  // namespace pliant
