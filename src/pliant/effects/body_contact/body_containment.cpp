#include "pliant/effects/body_contact/body_containment.h"

#include <Eigen/Geometry>
#include <utility>

#include "pliant/effects/self_contact/sheet_pairs.h"
#include "pliant/geometry/distance/winding_count.h"
#include "pliant/geometry/search/nearest_triangle.h"

namespace pliant {
namespace {

/// The vertices of a body, and its triangles among them.
TriangleMesh mesh_of(const BodySurfaces& surfaces, int body, const Positions& vertices) {
  const int first = surfaces.first(body), count = surfaces.count(body);
  TriangleMesh mesh;
  mesh.vertices = vertices.middleCols(first, count);
  mesh.triangles.resize(3, surfaces.triangles().cols());
  Eigen::Index own = 0;
  for (const auto t : surfaces.triangles().colwise()) {
    if (t[0] >= first && t[0] < first + count) mesh.triangles.col(own++) = t.array() - first;
  }
  mesh.triangles.conservativeResize(3, own);
  return mesh;
}

/// A solid, to be asked whether points are within.
class Solid {
 public:
  explicit Solid(const TriangleMesh& mesh)
      : box_(Eigen::Vector3d(mesh.vertices.rowwise().minCoeff()),
             Eigen::Vector3d(mesh.vertices.rowwise().maxCoeff())),
        winding_(mesh) {}

  /// Deeper than `depth` [m] below the surface.
  bool holds(const Eigen::Vector3d& p, double depth) {
    if (!box_.contains(p) || winding_(p) <= 0) return false;
    if (!nearest_) nearest_.emplace(winding_.mesh());
    return (*nearest_)(p).distance > depth;
  }

 private:
  Eigen::AlignedBox3d box_;
  WindingCount winding_;
  std::optional<NearestTriangle> nearest_;  // seldom needed
};

}  // namespace

std::optional<BodyContainment> find_containment(const BodySurfaces& surfaces,
                                                const Positions& vertices,
                                                const BodyPairTable& pairs) {
  for (int outer = 0; outer < pairs.bodies(); ++outer) {
    if (!surfaces.is_solid(outer)) continue;
    std::optional<Solid> solid;
    for (int inner = 0; inner < pairs.bodies(); ++inner) {
      if (!pairs.touches(inner, outer) || surfaces.count(inner) == 0) continue;
      if (!solid) solid.emplace(mesh_of(surfaces, outer, vertices));
      const double depth = sheet_pairs::kTouching * pairs(inner, outer).thickness;
      BodyContainment found{inner, outer, 0, false, Eigen::Vector3d::Zero()};
      const int first = surfaces.first(inner), end = first + surfaces.count(inner);
      for (int i = first; i < end; ++i) {
        if (!solid->holds(vertices.col(i), depth)) continue;
        if (found.count++ == 0) found.place = vertices.col(i);
      }
      found.are_all = found.count == end - first;
      if (found.count > 0) return found;
    }
  }
  return std::nullopt;
}

}  // namespace pliant
