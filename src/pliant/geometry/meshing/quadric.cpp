#include "pliant/geometry/meshing/quadric.h"

namespace pliant {

Quadric placed(const Quadric& c, const Eigen::Vector3d& origin, double scale) {
  Quadric result;
  result.head<6>() = c.head<6>() / (scale * scale);
  result.segment<3>(6) = c.segment<3>(6) / scale;
  result[9] = 0.0;
  const Eigen::Vector3d at_origin = gradient(result, -origin);
  result[9] = value(c, -origin / scale);
  result.segment<3>(6) = at_origin;
  return result;
}

}  // namespace pliant
