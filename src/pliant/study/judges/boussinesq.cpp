#include "pliant/study/judges/boussinesq.h"

#include <cmath>

namespace pliant {

Eigen::Vector3d boussinesq(double force, double young, double poisson, const Eigen::Vector3d& x) {
  const double shear = young / (2.0 * (1.0 + poisson));
  const double r = x.head<2>().norm(), z = -x.z(), distance = x.norm();
  const double unit = force / (4.0 * M_PI * shear * distance);
  const double outward =
      unit * (r * z / (distance * distance) - (1.0 - 2.0 * poisson) * r / (distance + z));
  const double down = unit * (2.0 * (1.0 - poisson) + z * z / (distance * distance));
  Eigen::Vector3d moved(0.0, 0.0, -down);
  if (r > 0.0) moved.head<2>() = outward / r * x.head<2>();
  return moved;
}

}  // namespace pliant
