#pragma once

#include <Eigen/Core>
#include <vector>

namespace pliant {

/// Finds which contacts between rigid bodies say nothing that others do not say. Where a flat face
/// touches a plane, the gap is linear along the face: where it stays open at the corners of what
/// touches, it stays open between them. The others of its hundreds of points share forces that
/// nothing determines, and cost as much.
class RedundantContacts {
 public:
  struct Place {
    int pair = 0;              ///< number of the two bodies that touch
    Eigen::Vector3d normal;    ///< of unit length
    Eigen::Vector3d position;  ///< [m]
    double gap = 0.0;          ///< [m]
  };

  /// What depends on others within `tolerance` [m] depends on them.
  explicit RedundantContacts(double tolerance) : tolerance_(tolerance) {}

  void clear() { places_.clear(); }
  void add(const Place& place) { places_.push_back(place); }
  int size() const { return static_cast<int>(places_.size()); }
  /// Of each place in the order in which it was added: whether others say what it says.
  const std::vector<char>& find();

 private:
  /// A place in a plane of contact.
  struct Flat {
    Eigen::Vector2d at;  // [m]
    double gap;          // [m]
    int place;
  };
  /// The gap as a linear function of places in the plane.
  struct Slope {
    Eigen::Vector2d origin;
    double gap;
    Eigen::Vector2d gradient;
    double operator()(const Eigen::Vector2d& at) const { return gap + gradient.dot(at - origin); }
  };

  /// Numbers those of the same pair and normal alike.
  void group();
  /// Puts the places of a group into their plane.
  void flatten(int first, int end);
  void find_in_plane();
  /// The corners of the places' outline, in turn.
  void find_outline();
  /// Appends those beyond the straight line between two corners.
  void add_beyond(int from, int to);
  /// Leaves out those that lie on the line between their neighbours.
  void straighten_outline();
  /// By the outline's corners; false: their gaps are not linear in their places.
  bool find_slope(Slope& slope) const;
  Eigen::Vector2d at(int flat) const { return flat_[static_cast<std::size_t>(flat)].at; }

  double tolerance_;
  std::vector<Place> places_;
  std::vector<char> is_redundant_;
  std::vector<int> group_of_, leaders_;  // of each place; a place of each group
  std::vector<int> order_;               // places, group by group
  std::vector<Flat> flat_;               // of the group that is looked at
  std::vector<int> outline_;             // among these
};

}  // namespace pliant
