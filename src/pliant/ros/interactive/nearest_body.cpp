#include "pliant/ros/interactive/nearest_body.h"

#include <algorithm>
#include <limits>

namespace pliant {

double distance_to(const Body& body, const Eigen::Vector3d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  const ForcePoints points = body.force_points();
  for (int i = 0; i < points.size(); ++i) {
    nearest = std::min(nearest, (points.position(i) - point).norm());
  }
  return nearest;
}

NearestBody nearest_body(const std::deque<Body>& bodies, const Eigen::Vector3d& point) {
  NearestBody nearest{0, std::numeric_limits<double>::infinity()};
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double distance = distance_to(bodies[b], point);
    if (distance < nearest.distance) nearest = {b, distance};
  }
  return nearest;
}

}  // namespace pliant
