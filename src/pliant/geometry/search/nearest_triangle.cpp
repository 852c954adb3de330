#include "pliant/geometry/search/nearest_triangle.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pliant/geometry/distance/closest_point.h"

namespace pliant {
namespace {

BoxTree tree_over(const TriangleMesh& mesh) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const auto t : mesh.triangles.colwise()) {
    Eigen::AlignedBox3d box(Eigen::Vector3d(mesh.vertices.col(t[0])));
    box.extend(mesh.vertices.col(t[1])).extend(mesh.vertices.col(t[2]));
    boxes.push_back(box);
  }
  return make_box_tree(boxes);
}

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

/// Looks into the nearer box first. Eigen's own search puts boxes in order by their distance, and
/// takes several times longer; which one of equally near triangles is found differs.
void find_nearest(const BoxTree& tree, int node, Search& search) {
  BoxTree::VolumeIterator box = nullptr, boxes_end = nullptr;
  BoxTree::ObjectIterator triangle = nullptr, triangles_end = nullptr;
  tree.getChildren(node, box, boxes_end, triangle, triangles_end);
  for (; triangle != triangles_end; ++triangle) search.minimumOnObject(*triangle);
  std::pair<double, int> children[2];
  int count = 0;
  for (; box != boxes_end; ++box) {
    children[count++] = {tree.getVolume(*box).squaredExteriorDistance(search.p), *box};
  }
  if (count == 2 && children[1].first < children[0].first) std::swap(children[0], children[1]);
  for (int k = 0; k < count && children[k].first < search.squared; ++k) {
    find_nearest(tree, children[k].second, search);
  }
}

}  // namespace

NearestTriangle::NearestTriangle(TriangleMesh mesh)
    : mesh_(std::move(mesh)), tree_(tree_over(mesh_)) {}

NearestTriangle::Result NearestTriangle::near(const Eigen::Vector3d& p, int hint) const {
  Search search{mesh_, p, {}};
  if (hint >= 0) search.minimumOnObject(hint);
  Eigen::BVMinimize(tree_, search);
  search.best.distance = std::sqrt(search.squared);
  return search.best;
}

double NearestTriangle::distance(const Eigen::Vector3d& p, double limit, int& hint) const {
  constexpr double kAbove = 1.0 + 1e-12;  // rounding leaves out nothing that is below the limit
  Search search{mesh_, p, {}, kAbove * limit * limit};
  if (hint >= 0) search.minimumOnObject(hint);
  find_nearest(tree_, tree_.getRootIndex(), search);
  if (search.best.triangle >= 0) hint = search.best.triangle;
  return std::min(limit, std::sqrt(search.squared));
}

}  // namespace pliant
