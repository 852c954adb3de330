#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/effects/self_contact/self_contact_detection.h"
#include "pliant/geometry/distance/barycentric.h"
#include "pliant/geometry/distance/closest_point.h"

namespace pliant {
namespace {

// How squarely a point and a triangle of one part have to face each other to touch (a cosine): what
// is pressed together sideways is compressed, not in contact.
constexpr double kFacing = 0.5;
// Longest edges of its tetrahedron that a point of the same part is away at rest to be a stranger.
constexpr double kStranger = 2.0;

bool share_a_particle(const Eigen::Vector4i& a, const Eigen::Vector4i& b) {
  for (int k = 0; k < 4; ++k) {
    if ((a.array() == b[k]).any()) return true;
  }
  return false;
}

double farthest(const Eigen::Matrix3d& corners, const Eigen::Vector3d& from) {
  return std::sqrt((corners.colwise() - from).colwise().squaredNorm().maxCoeff());
}

}  // namespace

void SelfContactDetection::find_near(int t, std::vector<Near>& found) const {
  const EmbeddedTriangle& triangle = parts_.triangles()[static_cast<std::size_t>(t)];
  const Eigen::Matrix3d corners = triangle.corners(surface_);
  const Eigen::Vector3d motion = (corners - triangle.corners(surface_start_)).rowwise().mean();
  Eigen::AlignedBox3d box(corners.rowwise().minCoeff(), corners.rowwise().maxCoeff());
  const double size = box.sizes().maxCoeff();
  const double fastest = std::min(size, spread_ + (motion - mean_motion_).norm());
  const double reach = thickness_ + margin_ + parts_.bulge() + fastest;
  box.min().array() -= reach;
  box.max().array() += reach;
  const Eigen::Vector3d normal =
      (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).stableNormalized();
  const EmbeddedPoints& points = parts_.points();
  const Eigen::Vector3d middle = corners.rowwise().mean();
  const Eigen::Matrix3d rest = triangle.corners(parts_.rest_surface());
  const Eigen::Vector3d rest_middle = rest.rowwise().mean();
  const double radius = farthest(corners, middle), rest_radius = farthest(rest, rest_middle);
  hash_.for_each_near(box, [&](int i) {
    if (!box.contains(points_.col(i))) return;
    if (share_a_particle(points.particles().col(i), triangle.particles)) return;
    if (parts_.part_of_point(i) == triangle.part) {
      // Cheap, and true of nearly all: it is not so much nearer than at rest as to touch.
      const double most_at_rest = (parts_.rest_points().col(i) - rest_middle).norm() + rest_radius;
      const double least_now = (points_.col(i) - middle).norm() - radius;
      if (least_now > kNearShare * most_at_rest) return;
    }
    look(i, t, corners, normal, std::min(size, (motions_.col(i) - motion).norm()), found);
  });
}

void SelfContactDetection::look(int point, int t, const Eigen::Matrix3d& corners,
                                const Eigen::Vector3d& normal, double motion,
                                std::vector<Near>& found) const {
  const Eigen::Vector3d p = points_.col(point);
  const Eigen::Vector3d on =
      closest_point_on_triangle(p, corners.col(0), corners.col(1), corners.col(2));
  const Eigen::Vector3d way = p - on;
  const double distance = way.norm(), height = way.dot(normal);
  const double reach = thickness_ + margin_ + motion;
  // Whether a point is inside is told by the nearest triangle, which may look another way than
  // this.
  if (!(distance <= reach + parts_.bulge())) return;
  Near near{point,
            parts_.triangles()[static_cast<std::size_t>(t)].part,
            t,
            triangle_weights(corners, on),
            distance,
            distance > 0.0 ? height / distance : 1.0,
            height < 0.0 || distance <= reach};
  if (!near.weights.allFinite()) return;
  if (parts_.part_of_point(point) == near.part) {
    if (std::abs(near.alignment) < kFacing) return;
    const double rest = rest_distance(near);
    // What is that near at rest is a neighbour, however little their tetrahedra share.
    if (rest < 2.0 * thickness_ || distance > kNearShare * rest) return;
  }
  found.push_back(near);
}

double SelfContactDetection::rest_distance(const Near& near) const {
  const EmbeddedTriangle& triangle = parts_.triangles()[static_cast<std::size_t>(near.triangle)];
  const Eigen::Vector3d on = triangle.corners(parts_.rest_surface()) * near.weights;
  return (parts_.rest_points().col(near.point) - on).norm();
}

void SelfContactDetection::find_deep(int t, const Positions& x, std::vector<Deep>& found) const {
  const Eigen::Vector4i particles = parts_.rest().tetrahedra.col(t);
  const Eigen::Matrix<double, 3, 4> corners = corners_of(x, particles);
  const Eigen::AlignedBox3d box(corners.rowwise().minCoeff(), corners.rowwise().maxCoeff());
  const int part = parts_.part_of_particle(particles[0]);
  const EmbeddedPoints& points = parts_.points();
  hash_.for_each_near(box, [&](int i) {
    if (!box.contains(points_.col(i))) return;
    if (share_a_particle(points.particles().col(i), particles)) return;
    const Eigen::Matrix3d sides = corners.rightCols<3>().colwise() - corners.col(0);
    if (!(sides.determinant() > 0.0)) return;
    const Eigen::Vector4d weights = Barycentric(corners)(points_.col(i));
    if (!(weights.minCoeff() >= 0.0)) return;
    if (parts_.part_of_point(i) == part) {
      const Eigen::Vector3d at = corners_of(parts_.rest().vertices, particles) * weights;
      const double far = kStranger * parts_.longest_edges()[static_cast<std::size_t>(t)];
      if ((at - parts_.rest_points().col(i)).norm() < far) return;
    }
    found.push_back({i, part, t, weights});
  });
}

}  // namespace pliant
