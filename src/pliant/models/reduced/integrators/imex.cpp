#include "pliant/models/reduced/integrators/imex.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

// Of λ in A once the body stiffened: h² K/(1 + h² A/4) then stays below 4/2.5, far enough from 4
// that the resonances of a nonlinear oscillator with the step stay out of reach.
constexpr double kGuardedShare = 2.5;
constexpr int kMaxSubsteps = 1024;

}  // namespace

void Imex::prepare_step(const ReducedSystem& system, double h) {
  damping_ = system.damping_rates();
  substeps_ = 1;
  split(system, h);
}

void Imex::split(const ReducedSystem& system, double h) {
  h_ = h;
  const Eigen::VectorXd& lambda = system.potential.lambda();
  const double smallest = options_.split / h;
  a_ = (lambda.array().sqrt() >= smallest).select(lambda, 0.0).asDiagonal();
  is_guarded_ = false;
  until_watch_ = options_.watch;
  known_q_.resize(0);
  factor();
}

void Imex::factor() {
  a_diagonal_ = a_.diagonal();
  is_diagonal_ = a_.isDiagonal(0.0);
  if (is_diagonal_) {
    drift_ = (1.0 + 0.5 * h_ * damping_.array() + 0.25 * h_ * h_ * a_diagonal_.array()).inverse();
    return;
  }
  Eigen::MatrixXd mass = 0.25 * h_ * h_ * a_;
  mass.diagonal().array() += 1.0 + 0.5 * h_ * damping_.array();
  drift_matrix_ = mass.llt().solve(Eigen::MatrixXd::Identity(mass.rows(), mass.cols()));
}

void Imex::apply_a(const Eigen::VectorXd& q, Eigen::VectorXd& result) const {
  if (is_diagonal_) {
    result = a_diagonal_.cwiseProduct(q);
  } else {
    result.noalias() = a_ * q;
  }
}

void Imex::evaluate_explicit(const ReducedSystem& system) {
  elastic_ = system.potential.evaluate(system.q, r_, space_);
  apply_a(system.q, aq_);
  g_ = r_ - aq_;
}

void Imex::make_step(ReducedSystem& system) {
  const double h = h_;
  system.p += 0.5 * h * (system.force - g_);
  g_before_ = system.p - 0.5 * h * aq_;
  if (is_diagonal_) {
    v_ = drift_.cwiseProduct(g_before_);
  } else {
    v_.noalias() = drift_matrix_ * g_before_;
  }
  g_before_ = g_;
  aq_before_ = aq_;
  system.q += h * v_;
  system.p = 2.0 * v_ - system.p;
  evaluate_explicit(system);
  system.p += 0.5 * h * (system.force - g_);
}

bool Imex::looks_unstable(const ReducedSystem& system) const {
  const double h = h_;
  // Δg·Δq / |Δq|² is a mean of the explicit tangent's eigenvalues over what moved.
  const double bound = options_.limit * options_.limit / (h * h);
  const double squared = h * v_.squaredNorm(), implicit = (aq_ - aq_before_).dot(v_);
  const double explicit_part = (g_ - g_before_).dot(v_);
  const double excess =
      is_guarded_ ? explicit_part + implicit * (1.0 - 0.25 * h * h * bound) : explicit_part;
  if (!(excess <= bound * squared)) return true;
  // A stable step swings about the energy that it had and was given, never far above.
  constexpr double kSwing = 4.0;
  const double before = elastic_before_ + 0.5 * p_before_.squaredNorm();
  const double given = h * std::abs(system.force.dot(v_)) + 0.5 * (h * system.force).squaredNorm();
  return !(elastic_ + system.kinetic_energy() <= kSwing * (before + given));
}

bool Imex::stabilise(const ReducedSystem& system, const Eigen::VectorXd& q, StepReport& report) {
  if (!q.allFinite()) return false;
  system.potential.evaluate(q, v_, tangent_, space_);
  if (options_.guard == ImexGuard::kSubstep) return add_substeps(system, report);
  return resplit(report);
}

bool Imex::add_substeps(const ReducedSystem& system, StepReport& report) {
  const double limit = options_.limit * options_.limit;
  shifted_ = tangent_ - a_;
  eigen_.compute(shifted_, Eigen::EigenvaluesOnly);
  const double squared = h_ * h_ * eigen_.eigenvalues()[shifted_.rows() - 1];
  if (squared <= limit || substeps_ >= kMaxSubsteps) return false;
  // Half the limit leaves room for more of the same.
  const int factor = std::max(2, static_cast<int>(std::ceil(std::sqrt(2.0 * squared / limit))));
  const int substeps = std::min(kMaxSubsteps, substeps_ * factor);
  const double step = h_ * substeps_;
  substeps_ = substeps;
  split(system, step / substeps);
  report.warn("substeps: the body stiffened, and steps are cut from here on");
  return true;
}

bool Imex::resplit(StepReport& report) {
  const double limit = options_.limit * options_.limit, bound = limit / (h_ * h_);
  int count = 0;
  if (!is_guarded_) {
    shifted_ = tangent_ - a_;
    eigen_.compute(shifted_, Eigen::EigenvaluesOnly);
    if (eigen_.eigenvalues()[shifted_.rows() - 1] <= bound) return false;
    is_guarded_ = true;
    a_ *= kGuardedShare;
    ++count;
  }
  shifted_ = tangent_ - 0.25 * limit * a_;
  eigen_.compute(shifted_);
  for (Eigen::Index i = 0; i < shifted_.rows(); ++i) {
    if (!(eigen_.eigenvalues()[i] > bound)) continue;
    // h² k = limit²/2 (1 + h² (a + δ)/4) in this direction
    const auto direction = eigen_.eigenvectors().col(i);
    const double a = direction.dot(a_ * direction);
    const double k = eigen_.eigenvalues()[i] + 0.25 * limit * a;
    const double added = 4.0 * (2.0 * k / limit - 1.0 / (h_ * h_)) - a;
    a_ += added * direction * direction.transpose();
    ++count;
  }
  if (count == 0) return false;
  factor();
  report.warn("resplit: the body stiffened, and more of it is implicit from here on");
  return true;
}

bool Imex::advance_stably(ReducedSystem& system, StepReport& report, bool is_last_trial) {
  for (int k = 0; k < substeps_; ++k) {
    q_before_ = system.q;
    p_before_ = system.p;
    elastic_before_ = elastic_;
    make_step(system);
    if (is_last_trial || !looks_unstable(system)) continue;
    // Both ends: the tangent where the step came from may be harmless.
    const Eigen::VectorXd q_after = system.q;
    const bool changed = stabilise(system, q_after, report);
    if (stabilise(system, q_before_, report) || changed) return false;
  }
  return true;
}

void Imex::advance(ReducedSystem& system, double, StepReport& report) {
  if (--until_watch_ < 0) {
    until_watch_ = options_.watch - 1;
    if (stabilise(system, system.q, report)) known_q_.resize(0);
  }
  if (known_q_.size() == 0 || known_q_ != system.q) evaluate_explicit(system);
  q_start_ = system.q;
  p_start_ = system.p;
  constexpr int kTrials = 8;
  for (int trial = 1; !advance_stably(system, report, trial == kTrials); ++trial) {
    system.q = q_start_;
    system.p = p_start_;
    evaluate_explicit(system);
  }
  known_q_ = system.q;
  report.iterations = substeps_;
  report.ended_by = EndedBy::kDirect;
}

void Imex::save(SavedNumbers& numbers) const {
  numbers.write_all(a_);
  numbers.write(substeps_);
  numbers.write(h_);
  numbers.write(until_watch_);
  numbers.write(is_guarded_ ? 1.0 : 0.0);
}

void Imex::load(SavedNumbers& numbers) {
  numbers.read_all(a_);
  substeps_ = static_cast<int>(numbers.read());
  h_ = numbers.read();
  until_watch_ = static_cast<int>(numbers.read());
  is_guarded_ = numbers.read() != 0.0;
  known_q_.resize(0);
  factor();
}

SolverRegistry::Entry Imex::entry() {
  return {
      "imex",
      "implicit-explicit variational integrator with a true split of the potential: one force a "
      "step, no iteration, its stability watched",
      {number_parameter("split", "", "0.5", 0.0, 1e6,
                        "coordinates with h w >= split begin implicit; 0 makes all so"),
       positive_parameter("limit", "", "1.5", 1.9,
                          "largest h w of the explicit part; above it more becomes implicit"),
       choice_parameter("guard", "substep", {"substep", "resplit"},
                        "what is done above the limit: substep keeps the energy true, resplit "
                        "the price of a step"),
       integer_parameter("watch", "32", 1, 1e6, "steps between looks at the tangent")},
      {"reduced"},
      [](const Parameters& parameters) {
        return std::make_unique<Imex>(ImexOptions{
            parameters.number("split"), parameters.number("limit"),
            parameters.text("guard") == "substep" ? ImexGuard::kSubstep : ImexGuard::kResplit,
            parameters.integer("watch")});
      }};
}

}  // namespace pliant
