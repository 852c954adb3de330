#pragma once

#include <Eigen/Core>

#include "pliant/core/state_archive.h"
#include "pliant/models/reduced/reduced_system.h"

namespace pliant {

/// The last line behind integrators that keep energy only where they converge: a body that is
/// compressed until its material collapses, or that swings in steps too long for it, must not gain
/// energy without bound. What a step adds beyond the work of the forces is summed, and taken back
/// where it exceeds half of the energy; smaller sums are the swing of a good integrator's energy.
class StepBalance {
 public:
  /// Before the integrator's step; `system.force` is known.
  void begin(const ReducedSystem& system);
  /// After it: changes q and p where they hold too much. Returns the energy that was taken [J].
  double end(ReducedSystem& system);
  /// Whether contact, attachments and other bodies, which move q and p after end(), left so much
  /// energy that it has to be compared with their work.
  bool has_to_compare(const ReducedSystem& system);
  /// From where they moved q.
  const Eigen::VectorXd& q_end() const { return q_end_; }
  /// Compares it: `force` is theirs, on the coordinates [kg^½ m/s²]. What their own motion added
  /// beyond the work is taken from p, and what p does not hold, from the shape by the next end():
  /// where they moved q to, nothing passes through the body. Returns the energy that was taken [J].
  double close(ReducedSystem& system, const Eigen::VectorXd& force);
  void undo_step();
  void reset() { surplus_ = in_shape_ = 0.0; }
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  /// V(q), computed once for each q.
  double elastic(const ReducedSystem& system);
  double energy(const ReducedSystem& system) { return elastic(system) + system.kinetic_energy(); }
  /// Takes what p has of the surplus.
  double slow_down(ReducedSystem& system);
  /// Goes back towards the start until the body can have no more than `energy` [J] at rest; and
  /// from there towards the rest shape, as far as the shape holds a surplus.
  void retreat(ReducedSystem& system, double energy);

  Eigen::VectorXd q_start_, q_end_;
  double start_ = 0.0;  // energy [J]
  Eigen::VectorXd known_q_, force_;
  double known_elastic_ = 0.0;  // at known_q_
  QuarticPotential::Workspace space_;
  double surplus_ = 0.0, surplus_start_ = 0.0;
  double in_shape_ = 0.0, in_shape_start_ = 0.0;  // of it, what close() left in q
};

}  // namespace pliant
