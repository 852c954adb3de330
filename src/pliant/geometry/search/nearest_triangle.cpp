#include "pliant/geometry/search/nearest_triangle.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pliant/geometry/distance/closest_point.h"

namespace pliant {
namespace {

/// What Eigen's BVMinimize asks for: lower bounds of boxes, squared distances of triangles.
struct Search {
  using Scalar = double;

  const TriangleMesh& mesh;
  const Eigen::Vector3d& p;
  NearestTriangle::Result best;
  double squared = std::numeric_limits<double>::infinity();

  double minimumOnVolume(const Eigen::AlignedBox3d& box) const {
    const double nearest = box.squaredExteriorDistance(p);
    // What is not nearer than what is known is not looked into.
    return nearest < squared ? nearest : std::numeric_limits<double>::max();
  }
  double minimumOnObject(int triangle) {
    const auto t = mesh.triangles.col(triangle);
    const Eigen::Vector3d point = closest_point_on_triangle(
        p, mesh.vertices.col(t[0]), mesh.vertices.col(t[1]), mesh.vertices.col(t[2]));
    const double distance = (point - p).squaredNorm();
    if (distance < squared) {
      squared = distance;
      best.triangle = triangle;
      best.point = point;
    }
    return distance;
  }
};

}  // namespace

NearestTriangle::NearestTriangle(TriangleMesh mesh)
    : mesh_(std::move(mesh)), tree_(make_box_tree(mesh_)) {}

NearestTriangle::Result NearestTriangle::near(const Eigen::Vector3d& p, int hint) const {
  Search search{mesh_, p, {}};
  if (hint >= 0) search.minimumOnObject(hint);
  Eigen::BVMinimize(tree_, search);
  search.best.distance = std::sqrt(search.squared);
  return search.best;
}

}  // namespace pliant
