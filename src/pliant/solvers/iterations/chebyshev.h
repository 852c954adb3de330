#pragma once

#include "pliant/laws/acceleration.h"
#include "pliant/solvers/iterations/implicit_euler.h"
#include "pliant/solvers/iterations/relaxation.h"

namespace pliant {

/// Chebyshev-accelerated Jacobi (Wang 2015, eqs. 8-10): with J one under-relaxed Jacobi iteration,
///   y_{k+1} = ω_{k+1} (J(y_k) − y_{k−1}) + y_{k−1},
///   ω = 1 at first, then 2/(2 − ρ²), then 4/(4 − ρ² ω).
/// ρ is estimated by a pre-simulation for this system and time step, of plain iterations and then
/// of accelerated ones. A recurrence that falls behind its promise begins anew with the larger ρ
/// that explains it (Hageman and Young 1981, chapter 6), one whose |J(y) − y| grows with a smaller
/// ρ; the best state is kept.
///
/// Contacts that come and go make of J no polynomial's argument. While any carries force,
/// Nesterov's momentum accelerates instead (Beck and Teboulle 2009), which needs no ρ: contact's
/// projection is the nearest admissible state in the norm of D. It is lost where it leads uphill
/// (O'Donoghue and Candès 2015).
class ChebyshevSolver final : public ImplicitEulerSolver {
 public:
  /// The radius is estimated by so many plain iterations, and then by at most so many accelerated
  /// ones, of which a share of the first change left is enough.
  static constexpr int kPreSimulation = 40, kEstimateIterations = 160;
  static constexpr double kEstimateChange = 1e-4;

  struct Options {
    int delay = 5;     ///< plain iterations before acceleration
    double rho = 0.0;  ///< spectral radius; 0 estimates it
  };
  ChebyshevSolver(const StopRule& rule, const Options& options)
      : ImplicitEulerSolver(rule), options_(options), iterations_(rule.iterations) {}
  std::string_view name() const override { return "chebyshev"; }
  /// No radius above it is of use in so many `iterations` after the `delay`, nor possible.
  static double largest_radius(const Relaxation& relaxation, double stiffness_ratio, int iterations,
                               int delay);

 protected:
  void save_learned(StateArchive& numbers) const override;
  void load_learned(StateArchive& numbers) override;
  void prepare_iterations(const ProjectiveSystem& system) override;
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  void go_on() override;
  void choose_end(ProjectiveSystem& system, StepReport& report) override;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;
  const Eigen::VectorXd& mobility() const override { return relaxation_.mobility; }

 private:
  void estimate(ProjectiveSystem& system, StepReport& report);
  /// The iterations of a step, from which the radius alone is kept: where they had to raise it,
  /// all steps begin with what they found. Plain iterations decay for long as if it were smaller.
  void estimate_radius(ProjectiveSystem& system);
  void begin_recurrence();
  /// One Jacobi iteration; returns |J(y) − y| in the norm of D [J^½].
  double jacobi(ProjectiveSystem& system, StepReport& report);
  /// Whether a change |J(y) − y| = γ |D^−½ r| says nothing any more.
  bool is_round_off(double change) const;
  void restart(int plain_iterations);
  /// From x = J(y) to the next y by Nesterov's momentum, which is lost where it leads uphill.
  void follow_momentum(Positions& x);
  double next_omega();
  void keep_best(const Positions& x, const IterationChange& change);

  Options options_;
  int iterations_;
  Relaxation relaxation_;
  SpectralRadius radius_;
  bool is_estimated_ = false;
  double estimate_ = 0.0;  // of the radius, with which each step begins
  double step_ = 0.0;      // that it is prepared for [s]
  double stale_ = -1.0;    // estimate for another step than that

  int plain_ = 0;        // plain iterations still to come
  int accelerated_ = 0;  // iterations since the recurrence began
  double omega_ = 1.0;
  double first_change_ = 0.0;    // |J(y) − y| where the recurrence began
  double earlier_change_ = 0.0;  // of the iteration before the last
  double last_change_ = 0.0;
  double best_change_ = 0.0;
  int restarts_ = 0;
  Positions before_;        // y_k
  Positions previous_;      // y_{k−1}
  Positions best_;          // J(y) of the smallest change
  bool touched_ = false;    // the last iteration met contact
  bool is_damped_ = false;  // with momentum, steps of γ grew
  bool is_plain_ = false;   // with these steps too: no momentum in the rest of this one
  Eigen::VectorXd damped_;  // mobility D⁻¹ / λ_max, with which momentum is surely stable
  double momentum_ = 1.0;   // t of Nesterov's sequence
  Positions projected_;     // J(y) of the last iteration that met contact
};

SolverRegistry::Entry chebyshev_entry();

}  // namespace pliant
