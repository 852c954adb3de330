#include "pliant/core/body/region.h"

#include <fmt/format.h>

#include "pliant/math/error.h"

namespace pliant {
namespace {

bool contains(const Region& region, const Eigen::Vector3d& point) {
  if (region.kind == Region::Kind::kBox) return region.box.contains(point);
  return (point - region.center).norm() <= region.radius;
}

}  // namespace

std::vector<int> particles_in(const Region& region, const Positions& x, int first, int count) {
  std::vector<int> found;
  if (region.kind == Region::Kind::kVertices) {
    for (int i : region.vertices) {
      if (i < 0 || i >= count) {
        throw InputError(fmt::format("there is no vertex {}: the last one is {}", i, count - 1));
      }
      found.push_back(first + i);
    }
    return found;
  }
  for (int i = first; i < first + count; ++i) {
    if (contains(region, x.col(i))) found.push_back(i);
  }
  return found;
}

}  // namespace pliant
