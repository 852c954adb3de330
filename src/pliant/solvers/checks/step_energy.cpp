#include "pliant/solvers/checks/step_energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "pliant/core/columns.h"
#include "pliant/core/step/step_report.h"

namespace pliant {
namespace {

// Gap below which a point lies in an obstacle [m].
constexpr double kOverlap = 1e-6;
// For which lost energy may be gained again, and what was gained counts [s].
constexpr double kMemory = 1.0;
// Of the displacement of a step that is held back: less than this is none.
constexpr double kLeastShare = 1e-3;
// Over constraints that the step's beginning violates; more of them part what lies in layers.
constexpr int kPartingSweeps = 30;

std::uint64_t stir(std::uint64_t print, std::uint64_t bits) {
  print = (print ^ bits) * 0x100000001b3ull;
  return print ^ print >> 29;
}

/// Of their bits; other ones have the same with a chance of 2^-64. Several prints, which do not
/// wait for each other, are stirred into one.
std::uint64_t fingerprint(const Positions& x) {
  std::array<std::uint64_t, 8> prints;
  for (std::size_t k = 0; k < prints.size(); ++k) prints[k] = 0x9e3779b97f4a7c15ull + k;
  const auto count = static_cast<std::size_t>(x.size());
  const auto bits_of = [&x](std::size_t k) {
    std::uint64_t bits;
    std::memcpy(&bits, x.data() + k, sizeof bits);
    return bits;
  };
  std::size_t at = 0;
  for (; at + prints.size() <= count; at += prints.size()) {
    for (std::size_t k = 0; k < prints.size(); ++k) prints[k] = stir(prints[k], bits_of(at + k));
  }
  std::uint64_t print = prints[0];
  for (std::size_t k = 1; k < prints.size(); ++k) print = stir(print, prints[k]);
  for (; at < count; ++at) print = stir(print, bits_of(at));
  return print;
}

/// Work that the constraints did on the path from the step's beginning [J].
double work_of_constraints(const ProjectiveSystem& system) {
  double sum = 0.0;
  for (const Constraint* constraint : system.constraints) {
    sum += constraint->work(system.particles.x);
  }
  return sum;
}

/// Pinned, or moved by another solver.
bool is_another(const ProjectiveSystem& system, int particle) {
  const auto& others = system.moved_by_others;
  return system.particles.is_fixed(particle) ||
         std::any_of(others.begin(), others.end(), [&](const std::pair<int, int>& range) {
           return particle >= range.first && particle < range.second;
         });
}

}  // namespace

void StepEnergy::prepare(double dt) {
  dt_ = dt;
  decay_ = std::exp(-dt / kMemory);
}

double StepEnergy::energy_of_displacement(const Particles& p, const Positions& from,
                                          const Positions& to) const {
  return parallel_sum(0, p.size(), kColumnGrain, [&](int i) {
    if (p.is_fixed(i)) return 0.0;
    return 0.5 * p.mass[i] / (dt_ * dt_) * (to.col(i) - from.col(i)).squaredNorm();
  });
}

double StepEnergy::kinetic(const Particles& p) const {
  return energy_of_displacement(p, p.x_inertial(), p.x);
}

void StepEnergy::find_energies(const ProjectiveSystem& system) {
  const std::uint64_t places = fingerprint(system.particles.x);
  if (places != places_) {
    kept_ = system.elastic_energy();
    given_ = work_of_constraints(system);
    // A viscous set's energy is 1/2 c (Δε)²/h of an effective step h, its power c (Δε/h)².
    const InertialStart& inertia = system.particles.inertia;
    const double steps = inertia.is_used ? inertia.whole / dt_ : 1.0;
    dissipated_ = 2.0 * steps * system.viscous_energy();
  }
  places_ = places;
}

double StepEnergy::total(const ProjectiveSystem& system) {
  find_energies(system);
  return kinetic(system.particles) + kept_ - given_;
}

bool StepEnergy::gains(const ProjectiveSystem& system) { return total(system) > most(); }

bool StepEnergy::gains_any(const ProjectiveSystem& system) { return total(system) > allowed_; }

bool StepEnergy::find_constraints(ProjectiveSystem& system) {
  constraints_.clear();
  // What others move is where it comes to be.
  starts_ = system.particles.x_start;
  for (int i = 0; i < starts_.cols(); ++i) {
    if (system.particles.is_fixed(i)) starts_.col(i) = system.particles.x.col(i);
  }
  for (Constraint* constraint : system.constraints) {
    if (!constraint->tells_energy()) return false;
    if (!constraint->tells_point_constraints()) continue;
    constraint->add_point_constraints(starts_, constraints_);
  }
  // What was found where wild iterations came, as the far side of a wall that they went through,
  // says nothing of where the step began: it was open there, or it would have been found at once.
  for (PointConstraint& constraint : constraints_.all) {
    if (constraint.is_late) constraint.gap = std::max(0.0, constraint.gap);
  }
  return true;
}

bool StepEnergy::starts_free() const {
  return std::all_of(constraints_.all.begin(), constraints_.all.end(),
                     [](const PointConstraint& c) { return c.gap >= -kOverlap; });
}

bool StepEnergy::nothing_arrives(const ProjectiveSystem& system) const {
  return std::all_of(
      constraints_.all.begin(), constraints_.all.end(), [&](const PointConstraint& c) {
        if (c.gap >= -kOverlap) return true;
        // The weights of a point add up to 1, those of the difference of two to 0.
        double sum = 0.0;
        bool with_another = false;
        for (int k = c.begin; k < c.end; ++k) {
          sum += constraints_.entries[k].weight;
          with_another = with_another || is_another(system, constraints_.entries[k].particle);
        }
        return sum < 0.5 && !with_another;
      });
}

void StepEnergy::part(const ProjectiveSystem& system) {
  const auto mobility_of = [&](int i) {
    return is_another(system, i) ? 0.0 : system.particles.inverse_mass[i];
  };
  const auto& all = constraints_.all;
  const auto entry = [this](int k) { return constraints_.entries[k]; };
  bool is_parted = false;
  for (int sweep = 0; sweep < kPartingSweeps && !is_parted; ++sweep) {
    is_parted = true;
    for (const PointConstraint& c : all) {
      double gap = c.gap, mobility = 0.0;
      for (int k = c.begin; k < c.end; ++k) {
        const auto [i, weight] = entry(k);
        gap += weight * c.normal.dot(starts_.col(i) - began_.col(i));
        mobility += weight * weight * mobility_of(i);
      }
      if (gap >= -kOverlap || mobility == 0.0) continue;
      is_parted = false;
      for (int k = c.begin; k < c.end; ++k) {
        const auto [i, weight] = entry(k);
        starts_.col(i) -= gap / mobility * weight * mobility_of(i) * c.normal;
      }
    }
  }
}

double StepEnergy::dragged() const {
  double sum = 0.0;
  for (const PointConstraint& constraint : constraints_.all) {
    const double pressing = std::max(0.0, constraint.normal_force - constraint.lowest);
    sum += constraint.friction * pressing * constraint.slip.norm();
  }
  return sum;
}

void StepEnergy::begin(ProjectiveSystem& system) {
  allowed_ = balanced_ = std::numeric_limits<double>::infinity();
  is_known_ = false;
  places_ = 0;
  if (!find_constraints(system)) return;
  is_known_ = nothing_arrives(system);
  const double work = dragged();
  began_ = starts_;
  starts_ = system.particles.x_start;
  balanced_ = allowed_ = from_start(system) + work;
  if (starts_free()) return;
  starts_ = began_;
  part(system);
  const double parted = from_start(system) + work;
  const double parting = energy_of_displacement(system.particles, began_, starts_);
  allowed_ = std::max(balanced_, parted + parting + 2.0 * std::sqrt(parted * parting));
  if (!is_known_) allowed_ *= kArrivals;
}

double StepEnergy::from_start(ProjectiveSystem& system) {
  Particles& p = system.particles;
  const double step = p.inertia.is_used ? p.inertia.whole : dt_;
  const double kinetic = parallel_sum(0, p.size(), kColumnGrain, [&](int i) {
    if (p.is_fixed(i)) return 0.0;
    Eigen::Vector3d v = p.v_start.col(i) + step * p.inverse_mass[i] * system.external_forces.col(i);
    v -= (starts_.col(i) - p.x_start.col(i)) / dt_;
    return 0.5 * p.mass[i] * v.squaredNorm();
  });
  p.x.swap(starts_);
  const double kept = system.elastic_energy() - work_of_constraints(system);
  p.x.swap(starts_);
  return kinetic + kept;
}

void StepEnergy::warn(StepReport& report) {
  report.warn(
      "energy_held_back: the step would end with more energy than it began with and forces gave: "
      "free bodies hardly change their shape in it, or it goes less far: take more iterations, "
      "newton or a smaller time step");
}

void StepEnergy::hold_back(ProjectiveSystem& system) {
  Particles& p = system.particles;
  end_ = p.x;
  for (double share = 0.5;; share *= 0.5) {
    if (share < kLeastShare) share = 0.0;
    p.x = p.x_start + share * (end_ - p.x_start);
    system.keep_rigid(p.x);
    if (share == 0.0 || !gains(system)) return;
  }
}

void StepEnergy::end(const ProjectiveSystem& system) {
  most_ = most();
  // Where it is not known what was allowed, nothing is known of what was lost.
  if (is_known()) {
    gained_ = total(system) + dissipated_ - balanced_;
    // What air would have given and nothing took is not lost.
    gained_ += std::clamp(-gained_, 0.0, std::max(0.0, given_));
    reserve_ -= gained_;
  }
  reserve_ *= decay_;
}

bool StepEnergy::allows(const Particles& p) const {
  const double kinetic = parallel_sum(0, p.size(), kColumnGrain, [&](int i) {
    return p.is_fixed(i) ? 0.0 : 0.5 * p.mass[i] * p.v.col(i).squaredNorm();
  });
  return kept_ - given_ + kinetic <= most_;
}

void StepEnergy::load(StateArchive& numbers) {
  const double reserve = numbers.read();
  reserve_ = std::isfinite(reserve) ? reserve : 0.0;
}

}  // namespace pliant
