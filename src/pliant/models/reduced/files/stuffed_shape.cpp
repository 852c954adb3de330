#include "pliant/models/reduced/files/stuffed_shape.h"

#include <cstddef>

#include "pliant/geometry/distance/distance_grid.h"
#include "pliant/geometry/meshing/isosurface_stuffing.h"
#include "pliant/geometry/repair/isosurface.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr int kMargin = 4;  // samples around the shape, as isosurface stuffing needs

DistanceGrid sampled(const FunctionShape& shape, double spacing) {
  DistanceGrid grid;
  grid.spacing = spacing;
  grid.count = ((shape.bounds.sizes() / spacing).array().ceil() + 1.0 + 2.0 * kMargin).cast<int>();
  grid.origin = shape.bounds.center() - 0.5 * spacing * (grid.count - 1).cast<double>().matrix();
  grid.samples.reserve(static_cast<std::size_t>(grid.count.prod()));
  for (int z = 0; z < grid.count[2]; ++z) {
    for (int y = 0; y < grid.count[1]; ++y) {
      for (int x = 0; x < grid.count[0]; ++x) {
        const Eigen::Vector3d at(x, y, z);
        grid.samples.push_back(static_cast<float>(shape.distance(grid.origin + spacing * at)));
      }
    }
  }
  return grid;
}

}  // namespace

StuffedShape stuff_shape(const FunctionShape& shape, double cell_size, double surface_spacing,
                         const std::string& name) {
  StuffedShape result{stuff_negative(sampled(shape, 0.5 * cell_size)),
                      isosurface(sampled(shape, surface_spacing))};
  if (result.mesh.tetrahedra.cols() == 0 || result.surface.triangles.cols() == 0) {
    throw InputError(name + ": no sample of the shape is inside");
  }
  return result;
}

}  // namespace pliant
