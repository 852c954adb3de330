#include "pliant/scene/reading/fixed_vertices.h"

#include <fmt/format.h>

#include "pliant/math/error.h"
#include "pliant/scene/yaml/place_error.h"

namespace pliant {
namespace {

int corner_vertex(const RegionSpec& region, const GridOptions& grid) {
  const int row = region.corner_top ? grid.rows - 1 : 0;
  return row * grid.columns + (region.corner_right ? grid.columns - 1 : 0);
}

}  // namespace

Region make_region(const RegionSpec& spec, const BodySpec& body) {
  Region region;
  switch (spec.kind) {
    case RegionSpec::Kind::kCorner:
      region.vertices = {corner_vertex(spec, *body.geometry.grid)};
      break;
    case RegionSpec::Kind::kVertices:
      region.vertices = spec.vertices;
      break;
    case RegionSpec::Kind::kBox:
      region.kind = Region::Kind::kBox;
      region.box = spec.box;
      break;
    case RegionSpec::Kind::kSphere:
      region.kind = Region::Kind::kSphere;
      region.center = spec.center;
      region.radius = spec.radius;
      break;
  }
  return region;
}

void fix_vertices(const BodySpec& body, Particles& particles) {
  for (const RegionSpec& fixed : body.fixed) {
    with_place(fmt::format("{}: body '{}'", fixed.place.text(), body.name), [&] {
      const auto found = particles_in(make_region(fixed, body), particles.x, 0, particles.size());
      if (found.empty()) {
        throw InputError(fixed.kind == RegionSpec::Kind::kBox ? "no vertex lies in the box"
                                                              : "no vertex lies in the sphere");
      }
      for (int i : found) particles.fix(i);
    });
  }
}

}  // namespace pliant
