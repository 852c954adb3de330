#pragma once

#include <vector>

#include "pliant/core/body/surface_bends.h"
#include "pliant/effects/contact/contact_detection.h"

namespace pliant {

/// The points of a body that touch, which follow its round surface to where that is nearest to what
/// they touch, anew in each step. Of several that come to one place one counts.
class FollowingPoints {
 public:
  /// `seeds` and `bends` outlive this; null: particles touch, and nothing bends.
  FollowingPoints(const EmbeddedPoints* seeds, const SurfaceBends* bends);

  /// The points as they are now; null: the particles. It stays where it is.
  const EmbeddedPoints* points() const { return follows() ? &points_ : seeds_; }
  bool follows() const { return bends_ != nullptr && !bends_->is_empty(); }
  double most_rise() const { return follows() ? bends_->most_rise() : 0.0; }
  /// Back to the seeds.
  void rewind();
  /// Moves the points of these contacts, which are of seeds, of particles at `x`. Points of several
  /// contacts stay. Returns whether any moved.
  bool follow(const std::vector<Contact>& contacts, const Positions& x);
  /// Leaves out contacts of points that came to where a nearer one is.
  void leave_out_doubles(std::vector<Contact>& contacts) const;

 private:
  struct Moved {
    int obstacle, point;
    double distance;  ///< from its seed [m]
    bool is_double;
    Eigen::Vector3d position;  ///< [m]
  };

  /// Of points that move with each of the contacts alone.
  void move(const std::vector<Contact>& contacts, const Positions& x);
  void find_doubles();

  const EmbeddedPoints* seeds_;
  const SurfaceBends* bends_;
  EmbeddedPoints points_;
  std::vector<Moved> moved_;
  std::vector<int> contacts_of_;  // of each point, while it is looked at
  std::vector<int> doubles_;      // points, in order
};

}  // namespace pliant
