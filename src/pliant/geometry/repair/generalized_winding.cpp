#include "pliant/geometry/repair/generalized_winding.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "pliant/math/pi.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

// A node counts as one dipole for points that are farther away than so many of its radii.
constexpr double kFarRadii = 2.0;

/// Of a triangle seen from p, positive from behind (van Oosterom and Strackee 1983).
double solid_angle(const Vector3d& p, const Vector3d& v0, const Vector3d& v1, const Vector3d& v2) {
  const Vector3d a = v0 - p, b = v1 - p, c = v2 - p;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double volume = a.dot(b.cross(c));
  const double below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return 2.0 * std::atan2(volume, below);
}

}  // namespace

GeneralizedWinding::GeneralizedWinding(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  std::vector<BoxHierarchy::Box> boxes;
  for (const auto t : mesh_.triangles.colwise()) {
    BoxHierarchy::Box box;
    for (int k = 0; k < 3; ++k) box.extend(Vector3d(mesh_.vertices.col(t[k])));
    boxes.push_back(box);
  }
  tree_.build(boxes);
  const std::vector<BoxHierarchy::Node>& nodes = tree_.nodes();
  dipoles_.resize(nodes.size());
  // Children come after their parents.
  for (std::size_t n = nodes.size(); n-- > 0;) {
    Dipole& dipole = dipoles_[n];
    Vector3d weighted = Vector3d::Zero();
    if (nodes[n].count > 0) {
      add_triangles(nodes[n], dipole);
    } else {
      for (const Dipole* child : {&dipoles_[n + 1], &dipoles_[nodes[n].right]}) {
        dipole.moment += child->moment;
        dipole.area += child->area;
        weighted += child->area * child->center;
      }
      dipole.center =
          dipole.area > 0.0 ? Vector3d(weighted / dipole.area) : Vector3d(nodes[n].box.center());
    }
    const Vector3d reach = (nodes[n].box.max() - dipole.center)
                               .cwiseAbs()
                               .cwiseMax((nodes[n].box.min() - dipole.center).cwiseAbs());
    dipole.radius = reach.norm();
  }
}

void GeneralizedWinding::add_triangles(const BoxHierarchy::Node& node, Dipole& dipole) const {
  Vector3d weighted = Vector3d::Zero();
  for (int k = node.first; k < node.first + node.count; ++k) {
    const auto t = mesh_.triangles.col(tree_.order()[k]);
    const Vector3d a = mesh_.vertices.col(t[0]), b = mesh_.vertices.col(t[1]),
                   c = mesh_.vertices.col(t[2]);
    const Vector3d moment = 0.5 * (b - a).cross(c - a);
    dipole.moment += moment;
    dipole.area += moment.norm();
    weighted += moment.norm() / 3.0 * (a + b + c);
  }
  dipole.center =
      dipole.area > 0.0 ? Vector3d(weighted / dipole.area) : Vector3d(node.box.center());
}

double GeneralizedWinding::operator()(const Vector3d& p) const {
  if (dipoles_.empty()) return 0.0;
  double sum = 0.0;
  int stack[64];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const int at = stack[--depth];
    const Dipole& dipole = dipoles_[at];
    const BoxHierarchy::Node& node = tree_.nodes()[at];
    const Vector3d away = dipole.center - p;
    const double distance = away.norm();
    if (distance > kFarRadii * dipole.radius && distance > 0.0) {
      sum += away.dot(dipole.moment) / (distance * distance * distance);
      continue;
    }
    for (int k = node.first; k < node.first + node.count; ++k) {
      const auto t = mesh_.triangles.col(tree_.order()[k]);
      sum += solid_angle(p, mesh_.vertices.col(t[0]), mesh_.vertices.col(t[1]),
                         mesh_.vertices.col(t[2]));
    }
    if (node.count > 0) continue;
    stack[depth++] = node.right;
    stack[depth++] = at + 1;
  }
  return sum / (4.0 * kPi);
}

}  // namespace pliant
