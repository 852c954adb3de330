#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pliant/core/obstacle.h"
#include "pliant/effects/contact/contact_detection.h"

namespace pliant {

/// Finds where two obstacles come closer than what is between them lets them: nothing that a solver
/// does makes room then, and a rigid body slips out, or sinks in.
class Pinching {
 public:
  /// Points are kept `offset` away from surfaces [m]. It counts as pinched where about twice that
  /// is missing: a rigid body is gripped by less.
  explicit Pinching(double offset) : offset_(offset) {}

  /// At the end of a step, with particles at `x` [m]. A cloth is pinched vertex by vertex, a solid,
  /// whose points are carried by particles, as a whole.
  void look(const ContactPoints& points, const Positions& x, const std::vector<Contact>& contacts,
            const std::vector<Obstacle>& obstacles);
  /// What to say of the last look; empty: nothing is pinched. It stays the same while the same two
  /// pinch, unless that becomes twice as bad.
  const std::string& text() const { return is_pinched_ ? text_ : none_; }
  /// Forgets the last look, of a step that is taken again.
  void undo();
  void reset();

 private:
  /// A contact that is not open.
  struct Closed {
    int point, obstacle;
    double missing;  // [m]
    Eigen::Vector3d normal;
  };
  struct Found {
    int one = -1, other = -1;  // obstacles, the lower number first
    double missing = 0.0;      // [m]
    int point = 0;             // where the most is missing
    int points = 0;            // at which it is more than what is told
  };

  void list(const ContactPoints& points, const Positions& x, const std::vector<Contact>& contacts);
  Found worst_vertex();
  Found worst_of_body();
  void take(const Closed& a, const Closed& b, Found& found) const;

  double offset_;
  std::vector<Closed> closed_, deepest_;  // all; of each obstacle one
  Found told_, told_before_;
  bool is_pinched_ = false, was_pinched_ = false;
  std::string text_;
  const std::string none_;
};

}  // namespace pliant
