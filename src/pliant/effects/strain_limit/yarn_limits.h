#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "pliant/core/system/constraint.h"
#include "pliant/core/system/element_set.h"
#include "pliant/effects/strain_limit/linear_constraints.h"
#include "pliant/effects/strain_limit/tethers.h"
#include "pliant/effects/strain_limit/yarn_projection.h"

namespace pliant {

/// Yarns that become no longer than a share of their length at rest, with forces that act in
/// pairs: by Gauss-Seidel sweeps, colour by colour, and at the end of a step by a projection of all
/// at once. Particles that are fixed or held hold others by tethers as well, so that a sweep
/// reaches from there to everywhere.
class YarnLimits {
 public:
  /// The springs named `stretch` and the triangles of `elements`; `max` >= 1 is the largest
  /// stretch. Throws InputError where there are none.
  YarnLimits(const std::vector<std::unique_ptr<ElementSet>>& elements, int particles, double max);

  /// Follows what is fixed or held.
  void begin_step(const Particles& particles, const std::vector<HeldVertex>& held) {
    tethers_.follow(particles, held);
  }
  void reset_multipliers();
  /// One sweep that moves x[i] by mobility[i] x force.
  void relax(const Eigen::VectorXd& mobility, Positions& x);
  /// The final projection: sweeps, and where these reach too slowly from what is held to what hangs
  /// on it, all yarns at once, until none is too long by more than `tolerance`, a share of its
  /// length. What it moves is no multiplier: nothing undoes it. It keeps the conditions of
  /// `keepers`.
  void hold(const Eigen::VectorXd& mobility, double tolerance,
            const std::vector<LinearConstraintProvider*>& keepers, Positions& x);
  /// A few sweeps where others moved it after hold() and one is too long by more than `tolerance`.
  /// Returns by how much one was.
  double alternating_projection(const Eigen::VectorXd& mobility, double tolerance, Positions& x);
  void add_forces(Forces& f) const;
  void add_rows(const Positions& x, ConstraintRows& rows) const;
  int active() const;

  /// Of all yarns, as a share of the length at rest; negative where all are shorter.
  double largest_strain(const Positions& x) const;
  const std::vector<Yarn>& yarns() const { return yarns_.all; }

 private:
  /// Goes a `share` of the distance to the limits. Returns by how much a yarn was too long at the
  /// most, as a share of its length.
  double sweep(double share, const Eigen::VectorXd& mobility, Positions& x);
  double project(std::size_t t, double share, const Eigen::VectorXd& mobility, Positions& x);

  double max_;
  Yarns yarns_;
  std::vector<Eigen::Vector3d> pulls_;  // multipliers, along the yarns [N]
  std::vector<double> block_largest_;
  Tethers tethers_;
  YarnProjection projection_;
};

}  // namespace pliant
