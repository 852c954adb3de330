#pragma once

#include <functional>

#include "pliant/models/reduced/files/stuffed_shape.h"

namespace pliant {

/// A smooth solid of ours: a few limbs, boxes and fillets.
struct SmoothShape {
  FunctionShape shape;
  double cell_size;        ///< of the tetrahedra [m]
  double surface_spacing;  ///< of the samples of its surface [m]
  std::function<bool(const Eigen::Vector3d&)> fixed;
  Eigen::Vector3d loaded;  ///< near the vertex that is pulled at
  Eigen::Vector3d load;    ///< direction of the pull
};

SmoothShape smooth_heart();   ///< 68 mm wide, its tip fixed
SmoothShape smooth_bridge();  ///< 0.4 m long, on two arches, its feet and ends fixed
SmoothShape smooth_tower();   ///< 0.4 m high, on four legs that bend inwards
SmoothShape smooth_horse();   ///< 0.29 m high to its ears, its hooves fixed

}  // namespace pliant
