#include "pliant/geometry/mesh/sheet_meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "pliant/math/error.h"

namespace pliant {
namespace {

void require_length(const std::string& what, double value) {
  if (std::isfinite(value) && value > 0.0) return;
  throw InputError(fmt::format("{} is {} m, but must be positive and finite", what, value));
}

void require_cells(const std::string& what, int value, int least) {
  if (value >= least) return;
  throw InputError(fmt::format("{} is {}, but must be at least {}", what, value, least));
}

/// Before any is made. `fields` are those that say how many, `factor` of their product.
void require_triangles(const std::string& fields, double factor, double product) {
  if (factor * product <= kMaxTriangles) return;
  throw InputError(fmt::format(
      "{} make {:.0f} triangles, but at most {} are allowed: a product of at most {:.0f}", fields,
      factor * product, kMaxTriangles, std::floor(kMaxTriangles / factor)));
}

/// Triangles of rows of `around` vertices each, closed around; `cells` rows of cells.
Eigen::Matrix3Xi ring_triangles(int around, int cells) {
  Eigen::Matrix3Xi triangles(3, 2 * around * cells);
  for (int row = 0, t = 0; row < cells; ++row) {
    for (int k = 0; k < around; ++k) {
      const int a = row * around + k, b = row * around + (k + 1) % around;
      const int c = a + around, d = b + around;
      if ((row + k) % 2 == 0) {
        triangles.col(t++) << a, b, d;
        triangles.col(t++) << a, d, c;
      } else {
        triangles.col(t++) << a, b, c;
        triangles.col(t++) << b, d, c;
      }
    }
  }
  return triangles;
}

/// Where share `s` in [0, 4) of the rectangle's sides lies, from its lower right corner on,
/// counter-clockwise.
Eigen::Vector2d on_rectangle(double s, double width, double height) {
  const Eigen::Vector2d corners[5] = {
      {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}};
  const int side = std::min(3, static_cast<int>(s));
  const double share = s - side;
  const Eigen::Vector2d unit = (1.0 - share) * corners[side] + share * corners[side + 1];
  return {width * unit.x(), height * unit.y()};
}

}  // namespace

TriangleMesh make_tube(const TubeOptions& options) {
  require_length("radius", options.radius);
  require_length("length", options.length);
  require_cells("around", options.around, 3);
  require_cells("along", options.along, 1);
  require_triangles(fmt::format("around {} and along {}", options.around, options.along), 2.0,
                    1.0 * options.around * options.along);
  TriangleMesh mesh;
  mesh.triangles = ring_triangles(options.around, options.along);
  mesh.vertices.resize(3, options.around * (options.along + 1));
  for (int row = 0; row <= options.along; ++row) {
    for (int k = 0; k < options.around; ++k) {
      const double angle = 2.0 * M_PI * k / options.around;
      mesh.vertices.col(row * options.around + k) << options.radius * std::cos(angle),
          options.radius * std::sin(angle),
          options.length * (static_cast<double>(row) / options.along - 0.5);
    }
  }
  return mesh;
}

TriangleMesh make_holed_sheet(const HoledSheetOptions& options) {
  require_length("width", options.width);
  require_length("height", options.height);
  require_length("hole", options.hole);
  require_cells("side", options.side, 1);
  require_cells("rings", options.rings, 1);
  require_triangles(fmt::format("side {} and rings {}", options.side, options.rings), 8.0,
                    1.0 * options.side * options.rings);
  const double least = 0.5 * std::min(options.width, options.height);
  if (!(options.hole < least)) {
    throw InputError(fmt::format(
        "hole is {} m, but must be less than half of the shorter side, {} m", options.hole, least));
  }
  const int around = 4 * options.side;
  TriangleMesh mesh;
  mesh.triangles = ring_triangles(around, options.rings);
  // Rings go outwards and counter-clockwise: turned round for normals along +z.
  mesh.triangles.row(1).swap(mesh.triangles.row(2));
  mesh.vertices.setZero(3, around * (options.rings + 1));
  for (int k = 0; k < around; ++k) {
    const Eigen::Vector2d outer = on_rectangle(4.0 * k / around, options.width, options.height);
    const Eigen::Vector2d inner = options.hole * outer.normalized();
    for (int ring = 0; ring <= options.rings; ++ring) {
      const double share = static_cast<double>(ring) / options.rings;
      mesh.vertices.col(ring * around + k).head<2>() = (1.0 - share) * inner + share * outer;
    }
  }
  return mesh;
}

}  // namespace pliant
