#pragma once

#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "pliant/geometry/search/point_hash.h"

namespace pliant {

/// The contact points of one part of a body, to find those in a box. What moves as one has little
/// motion of its own: a part that flies past another one does not widen the search within either.
class PartPoints {
 public:
  /// `numbers` are the columns of the part's points among those of the body.
  explicit PartPoints(std::vector<int> numbers) : numbers_(std::move(numbers)) {}

  /// Where the body's points are [m], how far each moved in the running step [m], and the edge of
  /// the cubes that they are sorted into [m].
  void build(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& motions, double cell);

  /// What no point of the part moves farther than, seen from what moves by `motion` [m].
  double most_beside(const Eigen::Vector3d& motion) const {
    return spread_ + (motion - mean_motion_).norm();
  }

  /// Calls visit(number) for each point in the box.
  template <class Visit>
  void for_each_within(const Eigen::AlignedBox3d& box, const Visit& visit) const;

 private:
  std::vector<int> numbers_;
  Eigen::Matrix3Xd points_;  // the part's own [m]
  Eigen::AlignedBox3d bounds_;
  Eigen::Vector3d mean_motion_ = Eigen::Vector3d::Zero();
  double spread_ = 0.0;  // largest difference of a point's motion and the mean [m]
  PointHash hash_;
};

template <class Visit>
void PartPoints::for_each_within(const Eigen::AlignedBox3d& box, const Visit& visit) const {
  if (!bounds_.intersects(box)) return;
  hash_.for_each_near(box, [&](int k) {
    if (box.contains(points_.col(k))) visit(numbers_[static_cast<std::size_t>(k)]);
  });
}

}  // namespace pliant
