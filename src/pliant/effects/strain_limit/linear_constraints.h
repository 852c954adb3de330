#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "pliant/core/body/particles.h"

namespace pliant {

class LinearConstraintProvider;

/// A linear condition on the displacement d of some particles, J d = c − C Δ, held by the forces
/// Jᵀ Δ, where Δ is by how much a multiplier of the constraint that asks for it changes.
struct LinearConstraint {
  struct Entry {
    int particle;
    Eigen::Vector3d gradient;  ///< its part of J
  };
  LinearConstraintProvider* owner = nullptr;
  int number = 0;  ///< of the owner's
  std::vector<Entry> entries;
  double target = 0.0;             ///< c
  double compliance = 0.0;         ///< C >= 0
  double least = 0.0, most = 0.0;  ///< of Δ
};

/// Those of several constraints. Reused, so that it allocates nothing once it is warm.
class LinearConstraints {
 public:
  void clear() { size_ = 0; }
  LinearConstraint& append() {
    if (size_ == all_.size()) all_.emplace_back();
    LinearConstraint fresh;
    fresh.entries.swap(all_[size_].entries);
    fresh.entries.clear();
    std::swap(all_[size_], fresh);
    return all_[size_++];
  }
  std::size_t size() const { return size_; }
  const LinearConstraint& operator[](std::size_t k) const { return all_[k]; }

 private:
  std::vector<LinearConstraint> all_;
  std::size_t size_ = 0;
};

/// A constraint with conditions that tie many particles and that the final projections of others
/// must keep: what moves all particles at once has to know of them. While that goes on multipliers
/// have changes, 0 at first.
class LinearConstraintProvider {
 public:
  virtual ~LinearConstraintProvider() = default;
  /// By how much the worst of them is missed at `x` with the changes, in what may be left of it.
  virtual double missed_linear_constraints(const Positions& x) = 0;
  /// Appends conditions on how particles go on from `x`, about where the changes are.
  virtual void add_linear_constraints(const Positions& x, LinearConstraints& conditions) = 0;
  virtual void set_change(int number, double change) = 0;
  /// The multipliers change so.
  virtual void take_changes() = 0;
};

}  // namespace pliant
