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
constexpr double kSideways = 1.7320509;  // its tangent
// Rounding lets no lower bound exceed what it bounds.
constexpr double kBelow = 1.0 - 1e-9;
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

struct SelfContactDetection::Face {
  int triangle;
  const EmbeddedTriangle& embedded;
  Eigen::Matrix3d corners;
  Eigen::Vector3d motion;  // of its middle in the running step [m]
  Eigen::AlignedBox3d box = {corners.rowwise().minCoeff(), corners.rowwise().maxCoeff()};
  double size = box.sizes().maxCoeff();
  Eigen::Vector3d normal =
      (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).stableNormalized();
  Eigen::Vector3d middle = corners.rowwise().mean();
  double radius = farthest(corners, middle);

  /// How far `p` is beyond the edges, along the face; less than 0 where it is between them [m].
  double beyond(const Eigen::Vector3d& p) const {
    double most = -size;
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d side = corners.col((c + 1) % 3) - corners.col(c);
      most = std::max(most, (p - corners.col(c)).dot(side.cross(normal)) / side.norm());
    }
    return most;
  }
};

void SelfContactDetection::find_near(int t, std::vector<Near>& found) const {
  const EmbeddedTriangle& triangle = parts_.triangles()[static_cast<std::size_t>(t)];
  const Eigen::Matrix3d corners = triangle.corners(surface_);
  const Eigen::Vector3d motion = (corners - triangle.corners(surface_start_)).rowwise().mean();
  const Face face{t, triangle, corners, motion};
  const double margin = thickness_ + margin_ + parts_.bulge();
  for (const PartPoints& part : part_points_) {
    const double reach = margin + std::min(face.size, part.most_beside(motion));
    const Eigen::Vector3d around = Eigen::Vector3d::Constant(reach);
    part.for_each_within({face.box.min() - around, face.box.max() + around}, [&](int i) {
      if (may_touch(i, face)) look(i, face, found);
    });
  }
}

double SelfContactDetection::reach(int point, const Face& face) const {
  const double motion = (motions_.col(point) - face.motion).norm();
  return thickness_ + margin_ + std::min(face.size, motion);
}

bool SelfContactDetection::may_touch(int point, const Face& face) const {
  const Eigen::Vector3d p = points_.col(point);
  const double least = kBelow * ((p - face.middle).norm() - face.radius);
  if (least > reach(point, face) + parts_.bulge()) return false;
  if (parts_.part_of_point(point) == face.embedded.part) {
    // What look() refuses as pressed together sideways.
    if (kBelow * face.beyond(p) >
        kSideways * std::abs((p - face.corners.col(0)).dot(face.normal))) {
      return false;
    }
    const Eigen::Matrix3d rest = face.embedded.corners(parts_.rest_surface());
    const Eigen::Vector3d middle = rest.rowwise().mean();
    const double most_at_rest =
        (parts_.rest_points().col(point) - middle).norm() + farthest(rest, middle);
    if (least > kNearShare * most_at_rest) return false;
  }
  return !share_a_particle(parts_.points().particles().col(point), face.embedded.particles);
}

void SelfContactDetection::look(int point, const Face& face, std::vector<Near>& found) const {
  const Eigen::Vector3d p = points_.col(point);
  const Eigen::Vector3d on =
      closest_point_on_triangle(p, face.corners.col(0), face.corners.col(1), face.corners.col(2));
  const Eigen::Vector3d between = p - on;
  const double distance = between.norm(), height = between.dot(face.normal);
  const double reach = this->reach(point, face);
  // Whether a point is inside is told by the nearest triangle, which may look another way than
  // this.
  if (!(distance <= reach + parts_.bulge())) return;
  Near near{point,
            face.embedded.part,
            face.triangle,
            triangle_weights(face.corners, on),
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
  for (const PartPoints& points : part_points_) {
    points.for_each_within(box, [&](int i) {
      if (share_a_particle(parts_.points().particles().col(i), particles)) return;
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
}

}  // namespace pliant
