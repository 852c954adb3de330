#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "pliant/core/coupling.h"
#include "pliant/core/element_set.h"
#include "pliant/effects/tethers.h"

namespace pliant {

/// A piece of yarn: a = Σ w x over its particles, whose length at rest is `length`. An edge of a
/// grid, or what warp or weft becomes within a triangle.
struct Thread {
  std::array<int, 3> particles;
  std::array<double, 3> weights;  ///< they sum to 0; the last is 0 for an edge
  double length;                  ///< [m]

  Eigen::Vector3d along(const Positions& x) const {
    const double* at = x.data();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      sum += weights[k] * Eigen::Map<const Eigen::Vector3d>(at + 3 * particles[k]);
    }
    return sum;
  }
};

/// Threads that become no longer than a share of their length at rest, with forces that act in
/// pairs, by Gauss-Seidel sweeps, colour by colour. Particles that are fixed or held hold others by
/// tethers as well, so that a sweep reaches from there to everywhere.
class ThreadLimits {
 public:
  /// The springs named `stretch` and the triangles of `elements`; `max` >= 1 is the largest
  /// stretch. Throws InputError where there are none.
  ThreadLimits(const std::vector<std::unique_ptr<ElementSet>>& elements, int particles, double max);

  /// Follows what is fixed or held.
  void begin_step(const Particles& particles, const std::vector<HeldVertex>& held) {
    tethers_.follow(particles, held);
  }
  void reset_multipliers();
  /// Moves x[i] by mobility[i] x force, in up to `sweeps`, fewer where no thread is too long by
  /// more than `tolerance`, a share of its length.
  /// Returns by how much one was at first.
  double relax(const Eigen::VectorXd& mobility, int sweeps, double tolerance, Positions& x);
  void add_forces(Forces& f) const;
  void add_rows(const Positions& x, CouplingRows& rows) const;
  int active() const;

  /// Of all threads, as a share of the length at rest; negative where all are shorter.
  double largest_strain(const Positions& x) const;
  const std::vector<Thread>& threads() const { return threads_; }

 private:
  void take_springs(const std::vector<std::unique_ptr<ElementSet>>& elements);
  void take_triangles(const std::vector<std::unique_ptr<ElementSet>>& elements);
  void sort(int particles);
  /// Goes a `share` of the way to the limits. Returns by how much a thread was too long at the
  /// most, as a share of its length.
  double sweep(double share, const Eigen::VectorXd& mobility, Positions& x);
  double project(std::size_t t, double share, const Eigen::VectorXd& mobility, Positions& x);

  double max_;
  std::vector<Thread> threads_;  // colour by colour
  std::vector<int> begins_;
  std::vector<Eigen::Vector3d> pulls_;  // multipliers, along the threads [N]
  std::vector<double> block_largest_;
  Tethers tethers_;
};

}  // namespace pliant
