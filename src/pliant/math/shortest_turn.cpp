#include "pliant/math/shortest_turn.h"

namespace pliant {

Eigen::Quaterniond shortest_turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  // Twice the cosine of half the angle: unlike 1 + cos it keeps its digits near half a turn.
  const double sum = (a + b).norm();
  constexpr double kOpposite = 1e-12;
  if (sum < kOpposite) {
    const Eigen::Vector3d axis = a.unitOrthogonal();
    return {0.0, axis.x(), axis.y(), axis.z()};
  }
  const Eigen::Vector3d axis = a.cross(b) / sum;
  return Eigen::Quaterniond(0.5 * sum, axis.x(), axis.y(), axis.z()).normalized();
}

}  // namespace pliant
