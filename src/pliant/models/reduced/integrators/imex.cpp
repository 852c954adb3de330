#include "pliant/models/reduced/integrators/imex.h"

#include <cmath>

namespace pliant {
namespace {

// After a false alarm, so that a body that swings at the limit does not pay for one in each step.
constexpr int kQuietSteps = 8;

}  // namespace

void Imex::prepare_step(const ReducedSystem& system, double h) {
  h_ = h;
  lambda_ = system.potential.lambda();
  damping_ = system.damping_rates();
  split_ = options_.split;
  stiffening_ = options_.stiffening;
  until_watch_ = options_.watch;
  quiet_ = 0;
  split();
}

void Imex::split() {
  a_ = (h_ * lambda_.array().sqrt() >= split_).select(stiffening_ * lambda_, 0.0);
  const double quarter = 0.25 * h_ * h_;
  drift_ = (1.0 + 0.5 * h_ * damping_.array() + quarter * a_.array()).inverse();
  unit_ = (a_.array() > 0.0)
              .select((1.0 + quarter * (a_ - lambda_).array()).rsqrt(),
                      Eigen::ArrayXd::Ones(a_.size()));
  known_q_.resize(0);
}

void Imex::evaluate_explicit(const ReducedSystem& system) {
  elastic_ = system.potential.evaluate(system.q, r_, space_);
  g_ = r_ - a_.cwiseProduct(system.q);
}

void Imex::make_step(ReducedSystem& system) {
  Eigen::VectorXd& p = system.p;
  p = p.cwiseQuotient(unit_) + 0.5 * h_ * (system.force - g_);
  v_ = drift_.cwiseProduct(p - 0.5 * h_ * a_.cwiseProduct(system.q));
  system.q += h_ * v_;
  p = 2.0 * v_ - p;
  r_before_ = r_;
  evaluate_explicit(system);
  p = unit_.cwiseProduct(p + 0.5 * h_ * (system.force - g_));
}

bool Imex::looks_unstable(const ReducedSystem& system) const {
  // Of what moved: its mean stiffness against its mean mass.
  const double limit = options_.limit * options_.limit;
  const double mass = v_.squaredNorm() + 0.25 * h_ * h_ * v_.dot(a_.cwiseProduct(v_));
  if (!(h_ * (r_ - r_before_).dot(v_) <= limit * mass)) return true;
  // A stable step swings about the energy that it had and was given, never far above.
  constexpr double kSwing = 4.0;
  const double before = elastic_before_ + 0.5 * p_before_.squaredNorm();
  const double given =
      h_ * std::abs(system.force.dot(v_)) + 0.5 * (h_ * system.force).squaredNorm();
  return !(elastic_ + system.kinetic_energy() <= kSwing * (before + given));
}

bool Imex::resplit(const ReducedSystem& system, const Eigen::VectorXd& q, StepReport& report) {
  if (!q.allFinite()) return false;
  const double limit = options_.limit * options_.limit, bound = limit / (h_ * h_);
  system.potential.evaluate(q, v_, tangent_, space_);
  const auto exceeds = [&] {
    Eigen::MatrixXd excess = tangent_;
    excess.diagonal() -= 0.25 * limit * a_;
    eigen_.compute(excess, Eigen::EigenvaluesOnly);
    return eigen_.eigenvalues()[q.size() - 1] > bound;
  };
  constexpr int kRaises = 40;  // of stiffening, together 10¹⁶
  int raises = 0;
  for (; raises < kRaises && exceeds(); ++raises) {
    stiffening_ *= 1.5;
    split_ *= 0.8;
    split();
  }
  if (raises > 0)
    report.warn("resplit: the body stiffened, and more of it is implicit from here on");
  return raises > 0;
}

void Imex::advance(ReducedSystem& system, double, StepReport& report) {
  if (--until_watch_ < 0) {
    until_watch_ = options_.watch - 1;
    resplit(system, system.q, report);
  }
  if (known_q_.size() == 0 || known_q_ != system.q) evaluate_explicit(system);
  q_before_ = system.q;
  p_before_ = system.p;
  elastic_before_ = elastic_;
  constexpr int kTrials = 8;
  for (int trial = 1;; ++trial) {
    make_step(system);
    if (trial == kTrials || --quiet_ >= 0 || !looks_unstable(system)) break;
    // Both ends of the step: the tangent where it came from may be harmless.
    const Eigen::VectorXd q_after = system.q;
    const bool changed = resplit(system, q_after, report);
    if (!resplit(system, q_before_, report) && !changed) {
      quiet_ = kQuietSteps;
      break;
    }
    system.q = q_before_;
    system.p = p_before_;
    evaluate_explicit(system);
  }
  known_q_ = system.q;
  report.iterations = 1;
  report.ended_by = EndedBy::kDirect;
}

void Imex::save(SavedNumbers& numbers) const {
  numbers.write(split_);
  numbers.write(stiffening_);
  numbers.write(until_watch_);
  numbers.write(quiet_);
}

void Imex::load(SavedNumbers& numbers) {
  split_ = numbers.read();
  stiffening_ = numbers.read();
  until_watch_ = static_cast<int>(numbers.read());
  quiet_ = static_cast<int>(numbers.read());
  split();
}

SolverRegistry::Entry Imex::entry() {
  return {
      "imex",
      "implicit-explicit variational integrator with a true split of the potential: one force a "
      "step, no iteration, its stability watched",
      {number_parameter("split", "", "1", 0.0, 1e6,
                        "coordinates with h w >= split are implicit; 0 makes all so"),
       number_parameter("stiffening", "", "2", 1.0, 1e6,
                        "stiffness of the implicit part over that at rest: how far fast "
                        "coordinates may stiffen"),
       positive_parameter("limit", "", "1.75", 2.0,
                          "largest h w of the step's motion; above it more becomes implicit"),
       integer_parameter("watch", "32", 1, 1e6, "steps between looks at the tangent")},
      {"reduced"},
      [](const Parameters& parameters) {
        return std::make_unique<Imex>(
            ImexOptions{parameters.number("split"), parameters.number("stiffening"),
                        parameters.number("limit"), parameters.integer("watch")});
      }};
}

}  // namespace pliant
