#pragma once

#include <Eigen/Core>
#include <deque>

#include "pliant/core/body.h"

namespace pliant {

struct NearestBody {
  std::size_t body = 0;   ///< its index; of equally near ones the first
  double distance = 0.0;  ///< of its nearest vertex [m]
};

/// Distance of a body's nearest vertex, or point on which users' forces act, from `point` [m].
double distance_to(const Body& body, const Eigen::Vector3d& point);

/// Of one body at least.
NearestBody nearest_body(const std::deque<Body>& bodies, const Eigen::Vector3d& point);

}  // namespace pliant
