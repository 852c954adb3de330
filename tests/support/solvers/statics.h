#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <utility>
#include <vector>

#include "pliant/core/system/element_set.h"

namespace pliant {

/// Element sets in static equilibrium with dead loads, by Newton's method with a line search: what
/// solvers are compared with, and independent of them.
class Statics {
 public:
  Statics(std::vector<const ElementSet*> sets, int particles)
      : load(Forces::Zero(3, particles)), sets_(std::move(sets)), free_(3 * particles, true) {}

  void fix(int particle) {
    for (int axis = 0; axis < 3; ++axis) fix(particle, axis);
  }
  void fix(int particle, int axis) { free_[static_cast<std::size_t>(3 * particle + axis)] = false; }

  double energy(const Positions& x) const;
  /// Load and elastic forces, those on fixed coordinates too.
  Forces forces(const Positions& x) const;
  /// Of the free coordinates.
  Eigen::VectorXd residual(const Positions& x) const;
  /// d²E/dx² over the free coordinates.
  Eigen::SparseMatrix<double> stiffness(const Positions& x, Definiteness definiteness) const;
  /// x moves by a vector over the free coordinates.
  void move(const Eigen::VectorXd& step, Positions& x) const;
  int count() const { return static_cast<int>(std::count(free_.begin(), free_.end(), true)); }
  /// From `x` until steps are round-off, `steps` at most. Returns the norm of the residual [N].
  double solve(Positions& x, int steps = 200) const;

  Forces load;  ///< [N]

 private:
  /// Halves the step until the energy falls, or near the solution, where the energy is round-off,
  /// the residual. False when neither does.
  bool search(const Eigen::VectorXd& step, const Eigen::VectorXd& r, Positions& x) const;

  std::vector<const ElementSet*> sets_;
  std::vector<bool> free_;
};

}  // namespace pliant
