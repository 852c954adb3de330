#include "pliant/models/reduced/integrators/trigonometric.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

constexpr int kMostParts = 64;

// Of half a turn: beyond it nothing would be left between a coordinate and its limit of stability.
constexpr double kWidestAngle = 0.95 * 3.14159265358979;
// Steps with room for fewer parts before there are fewer: each change of the parts changes the
// energy that the method keeps, so that there must not be one in every swing.
constexpr int kCalmSteps = 512;

}  // namespace

void Trigonometric::prepare_step(const ReducedSystem& system, double h) {
  h_ = h;
  omega_ = system.potential.lambda().cwiseSqrt();
  damping_ = system.damping_rates();
  is_damped_ = !damping_.isZero(0.0);
  least_mass_ = 1.0;
  least_parts_ = 1;
  until_watch_ = options_.watch;
  guard_.reset();
  known_q_.resize(0);
  use_parts(1);
}

double Trigonometric::exact_angle() const {
  return std::max(options_.exact / parts_, options_.slowed);
}

double Trigonometric::mass_of(double angle) const {
  const double turn = angle <= exact_angle() ? std::min(angle, kWidestAngle) : options_.slowed;
  // Below this, sin is its argument to the last digit.
  constexpr double kTinyAngle = 1e-8;
  if (turn < kTinyAngle) return least_mass_;
  const double ratio = 0.5 * angle / std::sin(0.5 * turn);
  return std::max(least_mass_, ratio * ratio);
}

void Trigonometric::use_parts(int parts) {
  parts_ = parts;
  calm_ = 0;
  part_ = h_ / parts;
  slowed_ = part_ * omega_.array() > exact_angle();
  mass_ = (part_ * omega_).unaryExpr([this](double angle) { return mass_of(angle); });
  bend_ = (part_ * omega_).cwiseAbs2();
  room_ = 4.0 * mass_ - bend_;
  unit_ = (0.25 * room_).array().rsqrt();
  drag_ = mass_.array() * (0.5 * part_ * damping_).array().tanh();
  drift_ = (mass_ + drag_).cwiseInverse();
  drag_ *= 2.0;
  set_response();
}

void Trigonometric::set_response() {
  // The parts of a step of small motion from rest under a unit force.
  const auto rank = omega_.size();
  w_.setZero(rank);  // p
  v_.setZero(rank);  // q
  for (int k = 0; k < parts_; ++k) {
    for (Eigen::Index i = 0; i < rank; ++i) {
      const double bend = bend_[i] / part_;  // h λ
      const double kicked = w_[i] + 0.5 * (part_ - bend * v_[i]);
      const double speed = drift_[i] * kicked;
      v_[i] += part_ * speed;
      w_[i] = 2.0 * mass_[i] * speed - kicked + 0.5 * (part_ - bend * v_[i]);
    }
  }
  response_.q = v_.cwiseMax(0.0);
  response_.p = w_.cwiseProduct(unit_);
}

void Trigonometric::divide(int parts) {
  // Slowed coordinates follow the others: they keep their velocity, which would else become a swing
  // of what has now less mass.
  was_slowed_ = slowed_;
  embedded_ = was_slowed_.select(mass_.cwiseInverse(), unit_);
  use_parts(parts);
  state_.p.array() *= embedded_.array() * was_slowed_.select(mass_, unit_.cwiseInverse()).array();
}

bool Trigonometric::make_part(const ReducedSystem& system) {
  const double h = part_, kinetic = kinetic_;
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

bool Trigonometric::make_parts(const ReducedSystem& system) {
  trial_ = {};
  kinetic_ = 0.5 * state_.p.cwiseProduct(unit_).squaredNorm();
  for (int k = 0; k < parts_; ++k) {
    if (!make_part(system)) return false;
  }
  return true;
}

int Trigonometric::parts_for(const ReducedSystem& system, const Eigen::VectorXd& q) {
  const int now = parts_;
  system.potential.evaluate(q, w_, tangent_, space_);
  tangent_.diagonal() -= omega_.cwiseAbs2();
  int parts = 1;
  for (; parts <= kMostParts; parts *= 2) {
    use_parts(parts);
    margin_ = -part_ * part_ * tangent_;
    margin_.diagonal() += options_.limit * room_;
    if (factor_.compute(margin_)) break;
  }
  use_parts(now);
  return parts;
}

bool Trigonometric::resplit(const ReducedSystem& system, const Eigen::VectorXd& q) {
  if (!q.allFinite()) return false;
  constexpr int kRaises = 100;  // together 10¹⁷
  int raises = 0;
  while (raises < kRaises && parts_for(system, q) > kMostParts) {
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
    made += parts_;
    if (make_parts(system)) break;
    std::swap(state_, before_);
    if (parts_ < kMostParts) {
      divide(2 * parts_);
    } else {
      // Both ends of the step: the tangent where it came from may be harmless.
      const bool at_end = resplit(system, before_.q), at_start = resplit(system, state_.q);
      if (!at_end && !at_start) {
        std::swap(state_, before_);  // of no instability: what it does to the energy is held
        break;
      }
      report.warn("resplit: the body stiffened, and more of it is slowed from here on");
      state_.p = state_.p.cwiseProduct(unit_);
      use_parts(parts_);
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

void Trigonometric::relax_parts() {
  // In half the parts T is eight times as large, (h ω)² four times.
  const bool has_room =
      trial_.worst <= options_.tolerance / 16.0 && trial_.stiffest <= 0.25 * options_.limit;
  calm_ = has_room && parts_ > least_parts_ ? calm_ + 1 : 0;
  if (calm_ >= kCalmSteps) use_parts(parts_ / 2);
}

void Trigonometric::advance(ReducedSystem& system, double, StepReport& report) {
  if (--until_watch_ < 0) {
    until_watch_ = options_.watch - 1;
    least_parts_ = std::min(kMostParts, parts_for(system, system.q));
    if (parts_ < least_parts_) use_parts(least_parts_);
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
  if (parts_ > 1) {
    report.add_metric("parts", parts_);
    relax_parts();
  }
}

void Trigonometric::save(StateArchive& numbers) const {
  numbers.write(least_mass_);
  for (const int number : {parts_, calm_, least_parts_, until_watch_}) numbers.write(number);
  guard_.save(numbers);
}

void Trigonometric::load(StateArchive& numbers) {
  least_mass_ = numbers.read();
  use_parts(static_cast<int>(numbers.read()));
  for (int* number : {&calm_, &least_parts_, &until_watch_}) {
    *number = static_cast<int>(numbers.read());
  }
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
