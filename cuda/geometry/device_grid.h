#pragma once

#include "cuda/core/vector.h"
#include "pliant/laws/shapes.h"

namespace pliant {

using DeviceSurfacePoint = ShapeDistance<Float3>;

/// Samples of the signed distance to a solid, interpolated as MeshShape
/// (src/pliant/geometry/distance/mesh_shape.h) does, in single precision. Lengths are in the
/// solid's frame.
struct DeviceGrid {
  const float* samples = nullptr;  ///< [m], x fastest; in the executor's memory
  int count[3] = {0, 0, 0};
  float spacing = 0.0f;                                        ///< [m]
  Float3 origin = {0.0f, 0.0f, 0.0f};                          ///< of the first sample [m]
  Float3 low = {0.0f, 0.0f, 0.0f}, high = {0.0f, 0.0f, 0.0f};  ///< bounds of the solid [m]
};

namespace device_grid_detail {

/// Where a coordinate is among the samples along an axis.
struct Along {
  int low;         ///< the sample below
  float fraction;  ///< 0..1 to the next one
  float beyond;    ///< from the nearest place of the grid [m]; 0 within
};

PLIANT_HOST_DEVICE inline Along along(float p, float origin, float spacing, int count) {
  const float at = (p - origin) / spacing, last = static_cast<float>(count - 1);
  const float within = at > 0.0f ? (at < last ? at : last) : 0.0f;  // 0 for NaN
  int low = static_cast<int>(within);
  low = low < count - 2 ? low : count - 2;
  return {low, within - static_cast<float>(low), at == within ? 0.0f : (at - within) * spacing};
}

}  // namespace device_grid_detail

PLIANT_HOST_DEVICE inline DeviceSurfacePoint query(const DeviceGrid& grid, Float3 p) {
  using device_grid_detail::along;
  const auto x = along(p.x, grid.origin.x, grid.spacing, grid.count[0]);
  const auto y = along(p.y, grid.origin.y, grid.spacing, grid.count[1]);
  const auto z = along(p.z, grid.origin.z, grid.spacing, grid.count[2]);
  const int row = grid.count[0], layer = row * grid.count[1];
  const float* c = grid.samples + layer * z.low + row * y.low + x.low;
  // Along x first; names say whether y and z are low or high.
  const float dx_ll = c[1] - c[0], dx_hl = c[row + 1] - c[row];
  const float dx_lh = c[layer + 1] - c[layer], dx_hh = c[layer + row + 1] - c[layer + row];
  const float ll = c[0] + x.fraction * dx_ll, hl = c[row] + x.fraction * dx_hl;
  const float lh = c[layer] + x.fraction * dx_lh, hh = c[layer + row] + x.fraction * dx_hh;
  const float low = ll + y.fraction * (hl - ll), high = lh + y.fraction * (hh - lh);
  const float dx_low = dx_ll + y.fraction * (dx_hl - dx_ll);
  const float dx_high = dx_lh + y.fraction * (dx_hh - dx_lh);
  const float dy_low = hl - ll, dy_high = hh - lh;
  DeviceSurfacePoint result = {low + z.fraction * (high - low),
                               {dx_low + z.fraction * (dx_high - dx_low),
                                dy_low + z.fraction * (dy_high - dy_low), high - low}};
  const float steepness = norm(result.normal);
  // Flat in the middle of the solid, where any direction leads out.
  result.normal = steepness > 1e-6f * grid.spacing ? (1.0f / steepness) * result.normal
                                                   : Float3{0.0f, 0.0f, 1.0f};
  const Float3 beyond = {x.beyond, y.beyond, z.beyond};
  const float outside = norm(beyond);
  if (outside > 0.0f) {
    // As MeshShape::query(): the mesh lies behind the grid's side.
    const Float3 between = beyond + result.distance * result.normal;
    result.normal = (1.0f / norm(between)) * between;
    result.distance = sqrtf(outside * outside + result.distance * result.distance);
  }
  return result;
}

}  // namespace pliant
