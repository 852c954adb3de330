#include "pliant/models/reduced/integrators/trigonometric.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

constexpr int kMostSubsteps = 64;

// Of half a turn: beyond it nothing would be left between a coordinate and its limit of stability.
constexpr double kWidestAngle = 0.95 * 3.14159265358979;
// Steps with room for fewer substeps before there are fewer: each change of the substeps changes
// the energy that the method keeps, so that there must not be one in every swing.
constexpr int kCalmSteps = 512;

}  // namespace

void Trigonometric::prepare_step(const ReducedSystem& system, double h) {
  h_ = h;
  omega_ = system.potential.lambda().cwiseSqrt();
  damping_ = system.damping_rates();
  is_damped_ = !damping_.isZero(0.0);
  least_mass_ = 1.0;
  least_substeps_ = 1;
  until_watch_ = options_.watch;
  guard_.reset();
  known_q_.resize(0);
  use_substeps(1);
}

double Trigonometric::exact_angle() const {
  return std::max(options_.exact / substeps_, options_.slowed);
}

double Trigonometric::mass_of(double angle) const {
  const double turn = angle <= exact_angle() ? std::min(angle, kWidestAngle) : options_.slowed;
  // Below this, sin is its argument to the last digit.
  constexpr double kTinyAngle = 1e-8;
  if (turn < kTinyAngle) return least_mass_;
  const double ratio = 0.5 * angle / std::sin(0.5 * turn);
  return std::max(least_mass_, ratio * ratio);
}

void Trigonometric::use_substeps(int substeps) {
  substeps_ = substeps;
  calm_ = 0;
  substep_ = h_ / substeps;
  slowed_ = substep_ * omega_.array() > exact_angle();
  mass_ = (substep_ * omega_).unaryExpr([this](double angle) { return mass_of(angle); });
  bend_ = (substep_ * omega_).cwiseAbs2();
  room_ = 4.0 * mass_ - bend_;
  unit_ = (0.25 * room_).array().rsqrt();
  drag_ = mass_.array() * (0.5 * substep_ * damping_).array().tanh();
  drift_ = (mass_ + drag_).cwiseInverse();
  drag_ *= 2.0;
  set_response();
}

void Trigonometric::set_response() {
  // The substeps of a step of small motion from rest under a unit force.
  const auto rank = omega_.size();
  w_.setZero(rank);  // p
  v_.setZero(rank);  // q
  for (int k = 0; k < substeps_; ++k) {
    for (Eigen::Index i = 0; i < rank; ++i) {
      const double bend = bend_[i] / substep_;  // h λ
      const double kicked = w_[i] + 0.5 * (substep_ - bend * v_[i]);
      const double speed = drift_[i] * kicked;
      v_[i] += substep_ * speed;
      w_[i] = 2.0 * mass_[i] * speed - kicked + 0.5 * (substep_ - bend * v_[i]);
    }
  }
  response_.q = v_.cwiseMax(0.0);
  response_.p = w_.cwiseProduct(unit_);
}

void Trigonometric::divide(int substeps) {
  // Slowed coordinates follow the others: they keep their velocity, which would else become a swing
  // of what has now less mass.
  was_slowed_ = slowed_;
  embedded_ = was_slowed_.select(mass_.cwiseInverse(), unit_);
  use_substeps(substeps);
  state_.p.array() *= embedded_.array() * was_slowed_.select(mass_, unit_.cwiseInverse()).array();
}

bool Trigonometric::make_substep(const ReducedSystem& system) {
  const double h = substep_, kinetic = kinetic_;
  w_ = state_.p + 0.5 * h * (system.force - state_.r);
  v_ = drift_.cwiseProduct(w_);
  state_.q += h * v_;
  const double elastic = state_.elastic, from = state_.r.dot(v_);
  state_.elastic = system.potential.evaluate(state_.q, state_.r, space_);
  state_.p = 2.0 * mass_.cwiseProduct(v_) - w_ + 0.5 * h * (system.force - state_.r);

  const double to = state_.r.dot(v_), inertia = v_.dot(mass_.cwiseProduct(v_));
  const double error = state_.elastic - elastic - 0.5 * h * (from + to);
  const double energy = 0.5 * (inertia + elastic + state_.elastic);
  kinetic_ = 0.5 * state_.p.cwiseProduct(unit_).squaredNorm();
  const double lost = is_damped_ ? v_.dot(drag_.cwiseProduct(v_)) : 0.0;
  const double surplus =
      kinetic_ - kinetic + state_.elastic - elastic - h * v_.dot(system.force) + lost;
  trial_.dissipated += lost;
  if (error != 0.0) {
    const double larger = std::max(std::abs(error), std::abs(surplus));
    trial_.worst = std::max(trial_.worst, larger / energy);
  }
  // Of a body at rest under a force, and of a linear one, the nonlinear change of R is round-off.
  constexpr double kRoundOff = 1e-12;
  const double stiffness = h * (to - from) - v_.dot(bend_.cwiseProduct(v_));
  if (stiffness > kRoundOff * h * (std::abs(from) + std::abs(to))) {
    trial_.stiffest = std::max(trial_.stiffest, stiffness / v_.dot(room_.cwiseProduct(v_)));
  }
  return trial_.stiffest <= options_.limit && trial_.worst <= options_.tolerance &&
         std::isfinite(energy);
}

bool Trigonometric::make_substeps(const ReducedSystem& system) {
  trial_ = {};
  kinetic_ = 0.5 * state_.p.cwiseProduct(unit_).squaredNorm();
  for (int k = 0; k < substeps_; ++k) {
    if (!make_substep(system)) return false;
  }
  return true;
}

int Trigonometric::substeps_for(const ReducedSystem& system, const Eigen::VectorXd& q) {
  const int now = substeps_;
  system.potential.evaluate(q, w_, tangent_, space_);
  tangent_.diagonal() -= omega_.cwiseAbs2();
  int substeps = 1;
  for (; substeps <= kMostSubsteps; substeps *= 2) {
    use_substeps(substeps);
    margin_ = -substep_ * substep_ * tangent_;
    margin_.diagonal() += options_.limit * room_;
    if (factor_.compute(margin_)) break;
  }
  use_substeps(now);
  return substeps;
}

bool Trigonometric::resplit(const ReducedSystem& system, const Eigen::VectorXd& q) {
  if (!q.allFinite()) return false;
  constexpr int kRaises = 100;  // together 10¹⁷
  int raises = 0;
  while (raises < kRaises && substeps_for(system, q) > kMostSubsteps) {
    least_mass_ *= 1.5;
    ++raises;
  }
  return raises > 0;
}

int Trigonometric::make_step(const ReducedSystem& system, StepReport& report) {
  before_ = state_;
  constexpr int kTrials = 16;
  int made = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    made += substeps_;
    if (make_substeps(system)) break;
    std::swap(state_, before_);
    if (substeps_ < kMostSubsteps) {
      divide(2 * substeps_);
    } else {
      // Both ends of the step: the tangent where it came from may be harmless.
      const bool at_end = resplit(system, before_.q), at_start = resplit(system, state_.q);
      if (!at_end && !at_start) {
        std::swap(state_, before_);  // of no instability: what it does to the energy is held
        break;
      }
      report.warn("resplit: the body stiffened, and more of it is slowed from here on");
      state_.p = state_.p.cwiseProduct(unit_);
      use_substeps(substeps_);
      state_.p = state_.p.cwiseQuotient(unit_);
    }
    before_ = state_;
  }
  return made;
}

void Trigonometric::hold_energy(ReducedSystem& system, StepReport& report) {
  EnergyChange change;
  change.before = before_.elastic + system.kinetic_energy();
  change.work = system.force.dot(state_.q - before_.q);
  change.dissipated = trial_.dissipated;
  system.q = state_.q;
  system.p = state_.p.cwiseProduct(unit_);
  const double kinetic = system.kinetic_energy();
  change.after = state_.elastic + kinetic;
  system.known_elastic = state_.elastic;
  const double taken = guard_.take(change, kinetic);
  if (taken == 0.0) return;
  system.p *= std::sqrt(1.0 - taken / kinetic);
  report.add_metric("energy_taken", taken);
  report.warn(
      "energy_held: the step is too long for this motion; what it would have added to the energy, "
      "or lost of it, was put right");
}

void Trigonometric::relax_substeps() {
  // In half the substeps T is eight times as large, (h ω)² four times.
  const bool has_room =
      trial_.worst <= options_.tolerance / 16.0 && trial_.stiffest <= 0.25 * options_.limit;
  calm_ = has_room && substeps_ > least_substeps_ ? calm_ + 1 : 0;
  if (calm_ >= kCalmSteps) use_substeps(substeps_ / 2);
}

void Trigonometric::advance(ReducedSystem& system, double, StepReport& report) {
  if (--until_watch_ < 0) {
    until_watch_ = options_.watch - 1;
    least_substeps_ = std::min(kMostSubsteps, substeps_for(system, system.q));
    if (substeps_ < least_substeps_) use_substeps(least_substeps_);
  }
  state_.q = system.q;
  state_.p = system.p.cwiseQuotient(unit_);
  if (known_q_.size() == 0 || known_q_ != system.q) {
    state_.elastic = system.potential.evaluate(state_.q, state_.r, space_);
  }
  report.iterations = make_step(system, report);
  report.ended_by = EndedBy::kDirect;
  hold_energy(system, report);
  known_q_ = system.q;
  if (substeps_ > 1) {
    report.add_metric("substeps", substeps_);
    relax_substeps();
  }
}

void Trigonometric::save(StateArchive& numbers) const {
  numbers.write(least_mass_);
  for (const int number : {substeps_, calm_, least_substeps_, until_watch_}) numbers.write(number);
  guard_.save(numbers);
}

void Trigonometric::load(StateArchive& numbers) {
  least_mass_ = numbers.read();
  use_substeps(static_cast<int>(numbers.read_whole(1, kMostSubsteps)));
  calm_ = static_cast<int>(numbers.read_whole(0, kCalmSteps));
  least_substeps_ = static_cast<int>(numbers.read_whole(1, 2 * kMostSubsteps));
  until_watch_ = static_cast<int>(numbers.read_whole(-1, options_.watch));
  guard_.load(numbers);
}

SolverRegistry::Entry Trigonometric::entry() {
  return {
      "trigonometric",
      "turns the coordinates by their own frequencies: one force a step, no iteration, symplectic; "
      "divides steps that are too long for the motion",
      {number_parameter(
           "exact", "", "3.14159", 0.0, 3.14159,
           "coordinates with h w up to this, or up to slowed, turn by the right angle"),
       positive_parameter("slowed", "rad", "1.4", 1.5,
                          "the angle by which faster coordinates turn in a step"),
       positive_parameter("limit", "", "0.7", 1.0,
                          "share of the room below the limit of stability that the stiffening of "
                          "the body may take; above it the step is divided"),
       positive_parameter("tolerance", "", "0.01", 1e6,
                          "largest error of the energy in a step, over the energy; above it the "
                          "step is divided"),
       positive_parameter("drift", "", "0.01", 1e6,
                          "largest lack of balance between energy, work and damping, over the "
                          "energy; above it the momentum makes it good"),
       integer_parameter("watch", "64", 1, 1e6, "steps between looks at the tangent")},
      {"reduced"},
      [](const Parameters& parameters) {
        return std::make_unique<Trigonometric>(
            TrigonometricOptions{parameters.number("exact"), parameters.number("slowed"),
                                 parameters.number("limit"), parameters.number("tolerance"),
                                 parameters.number("drift"), parameters.integer("watch")});
      }};
}

}  // namespace pliant
