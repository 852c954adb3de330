#include "pliant/geometry/distance/winding_count.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

namespace pliant {
namespace {

/// Twice the area, with a sign, of p and an edge seen from above. Neighbours give the edge's ends
/// in the one order or the other: the sum is always that of one order, so that its sign is too.
double side_of(const TriangleMesh& mesh, int i, int j, const Eigen::Vector3d& p) {
  const int low = std::min(i, j), high = std::max(i, j);
  const auto a = mesh.vertices.col(low), b = mesh.vertices.col(high);
  const double side = (b.x() - a.x()) * (p.y() - a.y()) - (p.x() - a.x()) * (b.y() - a.y());
  return i < j ? side : -side;
}

/// How often a triangle winds around p, both seen from above. An edge counts where it passes p's
/// height on one side, its lower end with it: so each point of the plane belongs to one of the
/// triangles around it.
int winding_from_above(const TriangleMesh& mesh, const Eigen::Vector3i& t,
                       const Eigen::Vector3d& p) {
  int count = 0;
  for (int k = 0; k < 3; ++k) {
    const int i = t[k], j = t[(k + 1) % 3];
    const bool starts_below = mesh.vertices(1, i) <= p.y(),
               ends_below = mesh.vertices(1, j) <= p.y();
    if (starts_below == ends_below) continue;
    const double side = side_of(mesh, i, j, p);
    if (starts_below && side > 0.0) ++count;
    if (ends_below && side < 0.0) --count;
  }
  return count;
}

}  // namespace

WindingCount::WindingCount(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  std::vector<BoxHierarchy::Box> boxes;
  for (const auto t : mesh_.triangles.colwise()) {
    BoxHierarchy::Box box;
    for (int k = 0; k < 3; ++k) box.extend(Eigen::Vector3d(mesh_.vertices.col(t[k])));
    boxes.push_back(box);
  }
  tree_.build(boxes);
  if (mesh_.vertices.cols() > 0) top_ = mesh_.vertices.row(2).maxCoeff();
}

int WindingCount::operator()(const Eigen::Vector3d& p) const {
  if (!(p.z() <= top_)) return 0;
  BoxHierarchy::Box ray(p);
  ray.extend(Eigen::Vector3d(p.x(), p.y(), top_));
  int count = 0;
  tree_.for_each_overlapping(ray, [&](int index) {
    const Eigen::Vector3i t = mesh_.triangles.col(index);
    const int winding = winding_from_above(mesh_, t, p);
    if (winding == 0) return;
    const Eigen::Vector3d a = mesh_.vertices.col(t[0]);
    const Eigen::Vector3d normal =
        (mesh_.vertices.col(t[1]) - a).cross(mesh_.vertices.col(t[2]) - a);
    // Above p: it turns up where the ray leaves what is within, and winds as it is seen.
    if (normal.dot(a - p) * normal.z() > 0.0) count += winding;
  });
  return count;
}

}  // namespace pliant
