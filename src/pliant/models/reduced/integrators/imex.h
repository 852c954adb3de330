#pragma once

#include <Eigen/Eigenvalues>

#include "pliant/models/reduced/integrators/integrator.h"

namespace pliant {

/// What is done when the explicit part's frequencies exceed their limit.
enum class ImexGuard {
  kSubstep,  ///< each step in parts from then on: the energy stays true, a step costs more
  kResplit,  ///< a larger A: a step costs the same, the fastest motions slow down and, since their
             ///< p is no longer their velocity, ½ p² swings
};

struct ImexOptions {
  /// Coordinates with h ω >= split begin in the implicit part.
  double split = 0.5;
  /// Largest h ω that the explicit part's tangent may have; below 2, where it becomes unstable.
  double limit = 1.5;
  ImexGuard guard = ImexGuard::kSubstep;
  /// Steps between two looks at that tangent; each step's own force shows most of what grows.
  int watch = 32;
};

/// Implicit-explicit variational integrator with a true split of the potential (Stern and Grinspun
/// 2009, "Implicit-explicit variational integration of highly oscillatory problems"):
///   V = ½ qᵀ A q + (V - ½ qᵀ A q),
/// the first part by the midpoint rule, in closed form since it is linear, the second by the
/// trapezoidal rule:
///   p⁺ = p + h/2 (f - R(q) + A q)
///   (I + h D/2 + h²/4 A) v = p⁺ - h/2 A q,  q' = q + h v,  p⁻ = 2 v - p⁺
///   p' = p⁻ + h/2 (f - R(q') + A q')
/// One evaluation of R a step, no iteration. It is Störmer-Verlet for the mass I + h²/4 A, so it is
/// stable about a state where h² (K(q) - A) < 4 I, whatever the frequencies in A.
///
/// A is diag(λ) of the fast coordinates. As a body stiffens with its deformation K(q) - A can pass
/// the bound. So the tangent is watched: where h² (K(q) - A) exceeds limit², the step that showed
/// it is undone and made again in parts ("substeps"), or with a larger A ("resplit", from then on
/// such that h² K(q) <= limit² (I + h² A/4)), and the report has a warning. Any constant symmetric
/// A and any constant number of parts keep the method second order, symplectic and reversible; a
/// change of them in motion is like a change of the integrator. Both only grow, so such changes end
/// by themselves.
class Imex final : public Integrator {
 public:
  explicit Imex(const ImexOptions& options) : options_(options) {}
  std::string_view name() const override { return "imex"; }
  /// A; for tests.
  const Eigen::MatrixXd& implicit_stiffness() const { return a_; }
  void save(SavedNumbers& numbers) const override;
  void load(SavedNumbers& numbers) override;
  static SolverRegistry::Entry entry();

 private:
  void prepare_step(const ReducedSystem& system, double h) override;
  void advance(ReducedSystem& system, double h, StepReport& report) override;
  void factor();
  /// A and what comes from it, for parts of `h`.
  void split(const ReducedSystem& system, double h);
  void make_step(ReducedSystem& system);
  /// All parts of a step; false when they looked unstable and something was done about it.
  bool advance_stably(ReducedSystem& system, StepReport& report, bool is_last_trial);
  /// R(q) - A q, the explicit part's force.
  void evaluate_explicit(const ReducedSystem& system);
  void apply_a(const Eigen::VectorXd& q, Eigen::VectorXd& result) const;
  /// Whether the last part shows a frequency beyond the limit, or energy from nowhere.
  bool looks_unstable(const ReducedSystem& system) const;
  /// Does what the guard says if the tangent at q exceeds the limit; whether it did.
  bool stabilise(const ReducedSystem& system, const Eigen::VectorXd& q, StepReport& report);
  bool add_substeps(const ReducedSystem& system, StepReport& report);
  bool resplit(StepReport& report);

  ImexOptions options_;
  double h_ = 0.0;  // of a part
  int substeps_ = 1;
  Eigen::MatrixXd a_;
  bool is_diagonal_ = true;
  bool is_guarded_ = false;  // whether the limit holds for h² K/(1 + h² A/4) too
  Eigen::VectorXd damping_;
  Eigen::VectorXd drift_;         // (I + h D/2 + h²/4 A)⁻¹ while A is diagonal
  Eigen::MatrixXd drift_matrix_;  // and when it is not
  Eigen::VectorXd a_diagonal_;
  int until_watch_ = 0;

  Eigen::VectorXd known_q_, r_, aq_, g_, v_;
  Eigen::VectorXd q_start_, p_start_;                           // of the step
  Eigen::VectorXd q_before_, p_before_, g_before_, aq_before_;  // of a part
  double elastic_ = 0.0, elastic_before_ = 0.0;
  Eigen::MatrixXd tangent_, shifted_;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen_;
  QuarticPotential::Workspace space_;
};

}  // namespace pliant
