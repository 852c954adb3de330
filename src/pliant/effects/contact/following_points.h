#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "pliant/core/body/surface_bends.h"
#include "pliant/core/state_archive.h"
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
  /// Back to the seeds. A step of `dt` [s] begins that predicts where the particles go, and may be
  /// undone. Contact turns a body further than that: as far as in the step before, but after a hit.
  void begin_step(const Particles& particles, double dt);
  /// Where it ended.
  void end_step(const Positions& x, double dt);
  void undo_step() { further_ = undone_; }
  void reset() { further_ = undone_ = Eigen::Vector3d::Zero(); }
  /// Moves the points of these contacts, which are of seeds, to where they touch at the step's end.
  /// Points of several contacts stay. Returns whether any moved.
  bool follow(const std::vector<Contact>& contacts);
  /// Leaves out contacts of points that came to where a nearer one is.
  void leave_out_doubles(std::vector<Contact>& contacts) const;
  /// Tells contacts how far round surfaces roll from where the step begins to its end as it is
  /// expected to be. In a step that turns the body by φ, the place under its middle slips along
  /// what it touches by φ × r, with r from the middle to it; the points of the body that come there
  /// move along arcs instead, by less.
  void roll(std::vector<Contact>& contacts, const Particles& particles) const {
    roll(contacts, particles, expected_);
  }
  /// The same of an end at `x`.
  void roll(std::vector<Contact>& contacts, const Particles& particles, const Positions& x) const;

  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  struct Moved {
    int obstacle, point;
    double distance;  ///< from its seed [m]
    bool is_double;
    Eigen::Vector3d position;  ///< [m]
  };

  /// Of points that move with each of the contacts alone.
  void move(const std::vector<Contact>& contacts);
  void find_doubles();
  /// By how much the point of a contact lacks what its surface rolls until the end at `x`, in a
  /// step that turns the body by `turn` [rad, m].
  Eigen::Vector3d lacks(const Contact& contact, const Eigen::AngleAxisd& turn,
                        const Positions& start, const Positions& x) const;

  const EmbeddedPoints* seeds_;
  const SurfaceBends* bends_;
  EmbeddedPoints points_;
  Positions predicted_, expected_;  // where the particles go without contact, and with it [m]
  // What contact turned the body by beyond the prediction, over the step's square, in the last step
  // and in the one before [rad/s²].
  Eigen::Vector3d further_ = Eigen::Vector3d::Zero(), undone_ = Eigen::Vector3d::Zero();
  std::vector<Moved> moved_;
  std::vector<int> contacts_of_;  // of each point, while it is looked at
  std::vector<int> doubles_;      // points, in order
};

}  // namespace pliant
