#include "pliant/models/reduced/step_balance.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pliant {
namespace {

constexpr double kAllowed = 0.5;   // of the energy
constexpr double kNoticed = 1.5;   // times the energy of the start
constexpr int kMostRetreats = 40;  // each by half
constexpr double kTowardsRest = 0.9;

}  // namespace

double StepBalance::elastic(const ReducedSystem& system) {
  if (known_q_.size() != system.q.size() || known_q_ != system.q) {
    known_q_ = system.q;
    known_elastic_ = system.potential.evaluate(system.q, force_, space_);
  }
  return known_elastic_;
}

void StepBalance::begin(const ReducedSystem& system) {
  q_start_ = system.q;
  start_ = energy(system);
  surplus_start_ = surplus_;
  in_shape_start_ = in_shape_;
}

void StepBalance::undo_step() {
  surplus_ = surplus_start_;
  in_shape_ = in_shape_start_;
}

void StepBalance::save(StateArchive& numbers) const {
  numbers.write(surplus_);
  numbers.write(in_shape_);
}

void StepBalance::load(StateArchive& numbers) {
  surplus_ = numbers.read();
  in_shape_ = numbers.read();
}

double StepBalance::end(ReducedSystem& system) {
  if (!std::isnan(system.known_elastic)) {
    known_q_ = system.q;
    known_elastic_ = system.known_elastic;
  }
  const double end = energy(system);
  const double work = system.force.dot(system.q - q_start_);
  surplus_ = std::max(0.0, surplus_ + end - start_ - work);
  in_shape_ = std::min(in_shape_, surplus_);
  double taken = 0.0;
  // What is not finite is for the world to undo.
  if (surplus_ > kAllowed * end && std::isfinite(end)) {
    taken = slow_down(system);
    if (surplus_ > 0.0) retreat(system, end - taken - surplus_);
    taken += std::exchange(surplus_, 0.0);
    // What contact adds again in this step is compared with what is left.
    start_ -= in_shape_;
    in_shape_ = 0.0;
  }
  q_end_ = system.q;
  return taken;
}

bool StepBalance::has_to_compare(const ReducedSystem& system) {
  return system.q != q_end_ && energy(system) > kNoticed * start_;
}

double StepBalance::close(ReducedSystem& system, const Eigen::VectorXd& force) {
  const double end = energy(system);
  const double gain = end - start_ - (system.force + force).dot(system.q - q_start_);
  if (!(gain > kAllowed * end) || !std::isfinite(end)) return 0.0;
  surplus_ = gain;
  const double taken = slow_down(system);
  in_shape_ = surplus_;
  return taken;
}

double StepBalance::slow_down(ReducedSystem& system) {
  const double kinetic = system.kinetic_energy();
  const double taken = std::min(surplus_, kinetic);
  system.p *= taken < kinetic ? std::sqrt(1.0 - taken / kinetic) : 0.0;
  surplus_ -= taken;
  return taken;
}

void StepBalance::retreat(ReducedSystem& system, double energy) {
  for (int k = 0; k < kMostRetreats; ++k) {
    if (elastic(system) <= energy) return;
    system.q = 0.5 * (system.q + q_start_);
  }
  system.q = q_start_;
  // What contact left in the shape, the start holds too. The rest shape holds nothing.
  const double most = std::max(energy, elastic(system) - in_shape_);
  for (int k = 0; k < kMostRetreats && elastic(system) > most; ++k) system.q *= kTowardsRest;
}

}  // namespace pliant
