#include "pliant/models/reduced/integrators/imex.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

constexpr int kMostParts = 16;

}  // namespace

void Imex::prepare_step(const ReducedSystem& system, double h) {
  h_ = h;
  lambda_ = system.potential.lambda();
  damping_ = system.damping_rates();
  is_damped_ = !damping_.isZero(0.0);
  a_ = (h_ * lambda_.array().sqrt() >= options_.split).select(options_.stiffening * lambda_, 0.0);
  parts_ = least_parts_ = 1;
  calm_ = 0;
  until_watch_ = options_.watch;
  guard_.reset();
  set_masses();
}

void Imex::set_masses() {
  const double quarter = 0.25 * h_ * h_;
  mass_ = 1.0 + quarter * a_.array();
  unit_ = (a_.array() > 0.0)
              .select((1.0 + quarter * (a_ - lambda_).array()).rsqrt(),
                      Eigen::ArrayXd::Ones(a_.size()));
  use_parts(parts_);
  known_q_.resize(0);
}

void Imex::use_parts(int parts) {
  parts_ = parts;
  calm_ = 0;
  drift_ = (mass_.array() + 0.5 * h_ / parts * damping_.array()).inverse();
}

bool Imex::make_part(const ReducedSystem& system) {
  const double h = h_ / parts_;
  const double c = 0.5 * h_ * h_ / h;  // A (q' - q) c is the momentum of A's mass
  w_ = state_.p + 0.5 * h * (system.force - state_.r) + c * a_.cwiseProduct(state_.q);
  v_ = drift_.cwiseProduct(w_ - c * a_.cwiseProduct(state_.q));
  state_.q += h * v_;
  const double elastic = state_.elastic, from = state_.r.dot(v_);
  state_.elastic = system.potential.evaluate(state_.q, state_.r, space_);
  state_.p = 2.0 * v_ - w_ + 0.5 * h * (system.force - state_.r) + c * a_.cwiseProduct(state_.q);

  const double to = state_.r.dot(v_), inertia = v_.dot(mass_.cwiseProduct(v_));
  const double error = state_.elastic - elastic - 0.5 * h * (from + to);
  const double energy = 0.5 * (inertia + elastic + state_.elastic);
  trial_.error += error;
  if (is_damped_) trial_.dissipated += h * v_.dot(damping_.cwiseProduct(v_));
  if (error != 0.0) trial_.worst = std::max(trial_.worst, std::abs(error) / energy);
  // Of a body at rest under a force, the change of R is round-off.
  constexpr double kRoundOff = 1e-12;
  const double stiffness = h * (to - from);
  if (stiffness > kRoundOff * h * (std::abs(from) + std::abs(to))) {
    trial_.stiffest = std::max(trial_.stiffest, stiffness / inertia);
  }
  return trial_.stiffest <= options_.limit * options_.limit && trial_.worst <= options_.tolerance &&
         std::isfinite(energy);
}

bool Imex::make_parts(const ReducedSystem& system) {
  trial_ = {};
  for (int k = 0; k < parts_; ++k) {
    if (!make_part(system)) return false;
  }
  return true;
}

int Imex::parts_for(const ReducedSystem& system, const Eigen::VectorXd& q) {
  system.potential.evaluate(q, v_, tangent_, space_);
  int parts = 1;
  for (; parts <= kMostParts; parts *= 2) {
    const double h = h_ / parts;
    margin_ = -h * h * tangent_;
    margin_.diagonal() += options_.limit * options_.limit * mass_;
    llt_.compute(margin_);
    if (llt_.info() == Eigen::Success) break;
  }
  return parts;
}

bool Imex::resplit(const ReducedSystem& system, const Eigen::VectorXd& q) {
  if (!q.allFinite()) return false;
  constexpr int kRaises = 100;  // together 10¹⁷
  int raises = 0;
  while (raises < kRaises && parts_for(system, q) > kMostParts) {
    a_ = 1.5 * a_.cwiseMax(2.0 / (h_ * h_));
    mass_ = 1.0 + 0.25 * h_ * h_ * a_.array();
    ++raises;
  }
  return raises > 0;
}

int Imex::make_step(const ReducedSystem& system, StepReport& report) {
  before_ = state_;
  constexpr int kTrials = 12;
  int made = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    made += parts_;
    if (make_parts(system)) break;
    std::swap(state_, before_);
    if (parts_ < kMostParts) {
      use_parts(2 * parts_);
    } else {
      // Both ends of the step: the tangent where it came from may be harmless.
      const bool at_end = resplit(system, before_.q), at_start = resplit(system, state_.q);
      if (!at_end && !at_start) {
        std::swap(state_, before_);  // of no instability: what it does to the energy is held
        break;
      }
      report.warn("resplit: the body stiffened, and more of it is implicit from here on");
      state_.p = state_.p.cwiseProduct(unit_);
      set_masses();
      state_.p = state_.p.cwiseQuotient(unit_);
      state_.elastic = system.potential.evaluate(state_.q, state_.r, space_);
    }
    before_ = state_;
  }
  return made;
}

void Imex::hold_energy(ReducedSystem& system, StepReport& report) {
  EnergyChange change;
  change.error = trial_.error;
  change.before = before_.elastic + system.kinetic_energy();
  change.work = system.force.dot(state_.q - before_.q);
  change.dissipated = trial_.dissipated;
  change.is_strained = parts_ > 1;
  system.q = state_.q;
  system.p = state_.p.cwiseProduct(unit_);
  const double kinetic = system.kinetic_energy();
  change.after = state_.elastic + kinetic;
  const double taken = guard_.take(change, kinetic);
  if (taken == 0.0) return;
  system.p *= std::sqrt(1.0 - taken / kinetic);
  report.add_figure("energy_taken", taken);
  report.warn(
      "energy_held: the step is too long for this motion; what it would have added to the energy, "
      "or lost of it, was put right");
}

void Imex::relax_parts() {
  // In half the parts T is eight times as large, (h ω)² four times.
  constexpr int kCalmSteps = 8;
  const bool has_room = trial_.worst <= options_.tolerance / 16.0 &&
                        trial_.stiffest <= 0.25 * options_.limit * options_.limit;
  calm_ = has_room && parts_ > least_parts_ ? calm_ + 1 : 0;
  if (calm_ >= kCalmSteps) use_parts(parts_ / 2);
}

void Imex::advance(ReducedSystem& system, double, StepReport& report) {
  state_.q = system.q;
  state_.p = system.p.cwiseQuotient(unit_);
  if (--until_watch_ < 0) {
    until_watch_ = options_.watch - 1;
    least_parts_ = std::min(kMostParts, parts_for(system, state_.q));
    if (parts_ < least_parts_) use_parts(least_parts_);
  }
  if (known_q_.size() == 0 || known_q_ != system.q) {
    state_.elastic = system.potential.evaluate(state_.q, state_.r, space_);
  }
  report.iterations = make_step(system, report);
  report.ended_by = EndedBy::kDirect;
  hold_energy(system, report);
  known_q_ = system.q;
  if (parts_ > 1) {
    report.add_figure("parts", parts_);
    report.warn("parts: the body moves too fast for the step, which was divided");
    relax_parts();
  }
}

void Imex::save(SavedNumbers& numbers) const {
  numbers.write_all(a_);
  for (const int number : {parts_, least_parts_, calm_, until_watch_}) numbers.write(number);
  guard_.save(numbers);
}

void Imex::load(SavedNumbers& numbers) {
  numbers.read_all(a_);
  parts_ = static_cast<int>(numbers.read());
  set_masses();
  for (int* number : {&least_parts_, &calm_, &until_watch_}) {
    *number = static_cast<int>(numbers.read());
  }
  guard_.load(numbers);
}

SolverRegistry::Entry Imex::entry() {
  return {
      "imex",
      "implicit-explicit variational integrator with a true split of the potential: one force a "
      "step, no iteration, its stability and energy watched",
      {number_parameter("split", "", "1", 0.0, 1e6,
                        "coordinates with h w >= split are implicit; 0 makes all so"),
       number_parameter("stiffening", "", "8", 1.0, 1e6,
                        "stiffness of the implicit part over that at rest; small values resonate "
                        "with the step in strong motion"),
       positive_parameter("limit", "", "1.3", 2.0,
                          "largest h w of the step's motion; above it the step is divided"),
       positive_parameter("tolerance", "", "0.05", 1e6,
                          "largest error of the energy in a step, over the energy; above it the "
                          "step is divided"),
       positive_parameter("drift", "", "0.05", 1e6,
                          "largest sum of these errors, over the energy; above it they are taken "
                          "back from the momentum"),
       integer_parameter("watch", "64", 1, 1e6, "steps between looks at the tangent")},
      {"reduced"},
      [](const Parameters& parameters) {
        return std::make_unique<Imex>(
            ImexOptions{parameters.number("split"), parameters.number("stiffening"),
                        parameters.number("limit"), parameters.number("tolerance"),
                        parameters.number("drift"), parameters.integer("watch")});
      }};
}

}  // namespace pliant
