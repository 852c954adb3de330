#pragma once

#include <Eigen/Eigenvalues>

#include "pliant/models/reduced/integrators/integrator.h"

namespace pliant {

struct ImexOptions {
  /// Coordinates with h ω >= split are in the implicit part.
  double split = 1.0;
  /// Aᵢ = stiffening λᵢ of these; >= 1. How far they may stiffen as the body deforms.
  double stiffening = 2.0;
  /// Largest h ω of the step's own motion, at most 2, where it becomes unstable.
  double limit = 1.75;
  /// Steps between two looks at the tangent; each step's own force shows most of what grows.
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
/// stable about a state where h² K(q) < 4 I + h² A, whatever the frequencies in A. Fast coordinates
/// stiffen most, by parts of their λ: so A is not diag(λ) of them but `stiffening` times as much,
/// which costs nothing but the speed of motions that the step does not resolve. Their momenta are
/// kept in units in which ½ p² + ½ λ q² of a small motion is constant, that is times
/// 1/√(1 + h² (A - λ)/4).
///
/// The tangent is watched: where h² K(q) exceeds limit² (I + h² A/4), `stiffening` is raised and
/// `split` lowered, the step that showed it is made again, and the report has the warning
/// "resplit". Any constant A keeps the method second order, symplectic and reversible; a change of
/// it in motion is like a change of the integrator. A only grows, so such changes end by
/// themselves.
class Imex final : public Integrator {
 public:
  explicit Imex(const ImexOptions& options) : options_(options) {}
  std::string_view name() const override { return "imex"; }
  /// Diagonal of A [1/s²].
  const Eigen::VectorXd& implicit_stiffness() const { return a_; }
  void save(SavedNumbers& numbers) const override;
  void load(SavedNumbers& numbers) override;
  static SolverRegistry::Entry entry();

 private:
  void prepare_step(const ReducedSystem& system, double h) override;
  void advance(ReducedSystem& system, double h, StepReport& report) override;
  void split();
  void make_step(ReducedSystem& system);
  /// R(q) - A q, the explicit part's force.
  void evaluate_explicit(const ReducedSystem& system);
  /// Whether the last step shows a frequency beyond the limit, or energy from nowhere.
  bool looks_unstable(const ReducedSystem& system) const;
  /// Makes A larger if the tangent at q exceeds the limit; whether it did.
  bool resplit(const ReducedSystem& system, const Eigen::VectorXd& q, StepReport& report);

  ImexOptions options_;
  double h_ = 0.0;
  double split_ = 0.0, stiffening_ = 0.0;  // as they are now
  Eigen::VectorXd lambda_, damping_;
  Eigen::VectorXd a_;
  Eigen::VectorXd drift_;  // 1/(1 + h D/2 + h² A/4)
  Eigen::VectorXd unit_;   // of the momenta
  int until_watch_ = 0;    // steps
  int quiet_ = 0;          // steps without a look

  Eigen::VectorXd known_q_, r_, g_, v_;
  Eigen::VectorXd q_before_, p_before_, r_before_;
  double elastic_ = 0.0, elastic_before_ = 0.0;
  Eigen::MatrixXd tangent_;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen_;
  QuarticPotential::Workspace space_;
};

}  // namespace pliant
