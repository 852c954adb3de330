#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace pliant {

/// A constraint on a point p = Σ w x of few particles, or on the difference of two such points: it
/// stays on one side of a plane, and slides there under Coulomb friction.
struct PointConstraint {
  int begin = 0, end = 0;        ///< of its entries
  Eigen::Vector3d normal;        ///< of length 1, to where it may go
  double gap = 0.0;              ///< along the normal; below 0 it is violated [m]
  bool is_contradicted = false;  ///< by one on the same point that points the other way
  bool is_rigid = false;         ///< between bodies that keep their shape
  bool is_late = false;          ///< found where iterations came, not when the step began
  double lowest = 0.0;           ///< normal force, 0 or what adhesion pulls with [N]
  double friction = 0.0;         ///< coefficient of what presses, that is of normal force - lowest
  /// Displacement over the surface since the step began [m].
  Eigen::Vector3d slip = Eigen::Vector3d::Zero();
  /// Of that, what a rigid body that stuck there was bent by in the step before [m].
  Eigen::Vector3d owed = Eigen::Vector3d::Zero();
  double normal_force = 0.0;                                 ///< multiplier [N]
  Eigen::Vector3d friction_force = Eigen::Vector3d::Zero();  ///< multiplier, tangential [N]
};

/// An equation that ties many particles, as the law of a gas does a volume and its pressure:
/// for displacements d and a multiplier λ that changes by Δ, Σ g · d + gap + compliance Δ = 0, with
/// forces g λ.
struct TyingConstraint {
  int begin = 0, end = 0;   ///< of its gradients
  double gap = 0.0;         ///< by how much it is missed [of the gradients, x m]
  double compliance = 0.0;  ///< >= 0 [gap per unit of the multiplier]
  /// Displacement of a particle beyond which the gradients say nothing [m].
  double reach = std::numeric_limits<double>::infinity();
  double force = 0.0;    ///< λ, its multiplier
  double lowest = 0.0;   ///< λ
  double highest = 0.0;  ///< λ
};

/// Reused, so that it allocates nothing once it is warm.
struct PointConstraints {
  struct Entry {
    int particle;
    double weight;
  };
  std::vector<PointConstraint> all;
  std::vector<Entry> entries;

  struct Gradient {
    int particle;
    Eigen::Vector3d value;
  };
  std::vector<TyingConstraint> ties;
  std::vector<Gradient> gradients;

  /// Of entries and gradients from these numbers on, the particles have numbers higher by `by`.
  void renumber(std::size_t first_entry, std::size_t first_gradient, int by) {
    for (std::size_t k = first_entry; k < entries.size(); ++k) entries[k].particle += by;
    for (std::size_t k = first_gradient; k < gradients.size(); ++k) gradients[k].particle += by;
  }
  void clear() {
    all.clear();
    entries.clear();
    ties.clear();
    gradients.clear();
  }
  /// Appends one without entries; add() gives it these.
  PointConstraint& append() {
    const int end = static_cast<int>(entries.size());
    all.emplace_back();
    all.back().begin = all.back().end = end;
    return all.back();
  }
  void add(int particle, double weight) {
    entries.push_back({particle, weight});
    all.back().end = static_cast<int>(entries.size());
  }
  /// Likewise of those that tie many.
  TyingConstraint& append_tie() {
    const int end = static_cast<int>(gradients.size());
    ties.emplace_back();
    ties.back().begin = ties.back().end = end;
    return ties.back();
  }
  void add_gradient(int particle, const Eigen::Vector3d& value) {
    gradients.push_back({particle, value});
    ties.back().end = static_cast<int>(gradients.size());
  }
};

}  // namespace pliant
