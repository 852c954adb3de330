#pragma once

#include <utility>
#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/core/state_archive.h"

namespace pliant {

/// Forces bend the stiff cluster of particles that a rigid body is made of by micrometres, and its
/// points move as it gets its shape back at a step's end. Where they stuck, friction takes that
/// back in the next step: else a box would creep down a slope, by as much in each step.
class RestoredShape {
 public:
  /// Numbers of what touches what.
  using Touching = std::pair<int, int>;

  void begin_step();
  /// Positions of particles that are about to get their shape back.
  void note_bent(const Positions& x);
  /// Whether the running step noted any.
  bool has_bent() const { return has_bent_; }
  void note_stuck(const Touching& touching);
  /// Particles' positions at the step's end, in their shapes.
  void end_step(const Positions& x);

  /// Whether anything stuck in the last step; of as many particles as these.
  bool owes(const Positions& x) const { return !stuck_.empty() && by_.cols() == x.cols(); }
  /// Whether what touches so did, and friction is to take back `by` [m]. Not what is longer than
  /// `most`, as no solver bends a rigid body: something was held back, or a saved state is damaged.
  bool owes(const Touching& touching, const Eigen::Vector3d& by, double most) const;
  /// What particles moved by as they got their shape back [m].
  const Positions& by() const { return by_; }
  Positions& by() { return by_; }

  void undo_step();
  void reset();
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  std::vector<Touching> stuck_, stuck_before_;  // in order
  Positions by_, by_before_;                    // [m]
  Positions bent_;                              // of the running step [m]
  bool has_bent_ = false;
};

}  // namespace pliant
