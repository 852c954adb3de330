#include "pliant/scene/fixed_vertices.h"

#include <fmt/format.h>

#include "pliant/math/error.h"

namespace pliant {
namespace {

int corner_vertex(const FixedSpec& fixed, const GridOptions& grid) {
  const int row = fixed.corner_top ? grid.rows - 1 : 0;
  return row * grid.columns + (fixed.corner_right ? grid.columns - 1 : 0);
}

void fix_listed(const BodySpec& body, const FixedSpec& fixed, Particles& particles) {
  for (int i : fixed.vertices) {
    if (i >= particles.size()) {
      throw InputError(fmt::format("{}: body '{}' has no vertex {}: the last one is {}",
                                   fixed.place.text(), body.name, i, particles.size() - 1));
    }
    particles.fix(i);
  }
}

void fix_inside(const BodySpec& body, const FixedSpec& fixed, Particles& particles) {
  bool found = false;
  for (int i = 0; i < particles.size(); ++i) {
    if (!fixed.box.contains(particles.x.col(i))) continue;
    particles.fix(i);
    found = true;
  }
  if (!found) {
    throw InputError(
        fmt::format("{}: no vertex of body '{}' lies in the box", fixed.place.text(), body.name));
  }
}

}  // namespace

void fix_vertices(const BodySpec& body, Particles& particles) {
  for (const FixedSpec& fixed : body.fixed) {
    switch (fixed.kind) {
      case FixedSpec::Kind::kCorner:
        particles.fix(corner_vertex(fixed, *body.geometry.grid));
        break;
      case FixedSpec::Kind::kVertices:
        fix_listed(body, fixed, particles);
        break;
      case FixedSpec::Kind::kBox:
        fix_inside(body, fixed, particles);
        break;
    }
  }
}

}  // namespace pliant
