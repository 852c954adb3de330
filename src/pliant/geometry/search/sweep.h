#ifndef PLIANT_GEOMETRY_SWEEP_H_
#define PLIANT_GEOMETRY_SWEEP_H_

#include <Eigen/Core>

#include "pliant/geometry/distance/shape.h"

namespace pliant {

struct SweepHit {
  bool hit;                // false: time is 1, point is `to`, normal is +z
  double time;             // first contact as a fraction of the path, 0..1
  Eigen::Vector3d point;   // the moving point at that time, in the shape's frame [m]
  Eigen::Vector3d normal;  // the shape's unit outward normal there, in the shape's frame
};

// When a point that moves straight from `from` to `to` (its positions in the shape's own frame at
// the start and the end of a step) first comes within `offset` [m] of the shape.
//
// A start within the offset hits at time 0. Convex shapes are never passed through, however thin or
// fast, and contact is found to 1e-9 of the lengths involved. For other shapes a grazing contact
// that digs in along less than 1/256 of the path through the shape's bounds may go unseen. One
// distance query where the point cannot reach the shape; positions that are not finite never hit.
SweepHit sweep_point(const Shape& shape, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                     double offset);

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_SWEEP_H_
