#include "pliant/effects/air/trapped_volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

#include "pliant/geometry/distance/primitive_shapes.h"

namespace pliant {
namespace {

/// From its foot to a vertex that is not below it.
Eigen::Vector3d rise(int i, const Positions& x, const FootPoints& foot_points) {
  const Eigen::Vector3d offset = x.col(i) - foot_points.places.col(i),
                        normal = foot_points.normals.col(i);
  return offset - std::min(0.0, normal.dot(offset)) * normal;
}

double prism_volume(const Eigen::Vector3i& t, const Eigen::Vector3d& shares, const Positions& x,
                    const FootPoints& foot_points) {
  const Eigen::Vector3d d0 = rise(t[0], x, foot_points), d1 = rise(t[1], x, foot_points),
                        d2 = rise(t[2], x, foot_points);
  const Eigen::Vector3d up = shares[0] * d0 + shares[1] * d1 + shares[2] * d2,
                        q = foot_points.places.col(t[0]);
  const Eigen::Vector3d a = foot_points.places.col(t[1]) - q, b = foot_points.places.col(t[2]) - q;
  const Eigen::Vector3d u = d1 - d0, v = d2 - d0;
  const Eigen::Vector3d mean = a.cross(b) + 0.5 * (a.cross(v) + u.cross(b)) + u.cross(v) / 3.0;
  return mean.dot(up) / 2.0;
}

}  // namespace

FootFinder::FootFinder(const std::vector<Obstacle>& obstacles, std::vector<int> chosen)
    : obstacles_(obstacles), chosen_(std::move(chosen)) {
  const auto& first = obstacles[static_cast<std::size_t>(chosen_.front())].shape;
  is_plane_ = chosen_.size() == 1 && as<Plane>(*first) != nullptr;
}

void FootFinder::find(const Positions& x, double offset, FootPoints& foot_points) const {
  const auto n = x.cols();
  foot_points.are_flat = is_plane_;
  foot_points.nearest.assign(static_cast<std::size_t>(n), chosen_.front());
  if (is_plane_) {
    const Eigen::Isometry3d& pose = obstacles_[static_cast<std::size_t>(chosen_.front())].pose_end;
    const Eigen::Vector3d normal = pose.linear().col(2);
    foot_points.ground = {normal, normal.dot(pose.translation()) + offset};
    heights_above(x, foot_points.ground, foot_points.heights);
    return;
  }
  foot_points.places.resize(3, n);
  foot_points.normals.resize(3, n);
  foot_points.heights.setConstant(n, std::numeric_limits<double>::infinity());
  for (const int o : chosen_) {
    const Obstacle& obstacle = obstacles_[static_cast<std::size_t>(o)];
    const Eigen::Isometry3d local = obstacle.pose_end.inverse();
    for (int i = 0; i < n; ++i) {
      const SurfacePoint surface = obstacle.shape->query(local * x.col(i));
      const double height = surface.distance - offset;
      if (!(height < foot_points.heights[i])) continue;
      foot_points.heights[i] = height;
      foot_points.normals.col(i) = obstacle.pose_end.linear() * surface.normal;
      foot_points.nearest[static_cast<std::size_t>(i)] = o;
    }
  }
  for (int i = 0; i < n; ++i) {
    foot_points.places.col(i) = x.col(i) - foot_points.heights[i] * foot_points.normals.col(i);
  }
  foot_points.heights = foot_points.heights.cwiseMax(0.0);
}

double trapped_volume(const CoverTriangles& triangles, const Positions& x,
                      FootPoints& foot_points) {
  if (foot_points.are_flat) {
    foot_points.column.place(x, foot_points.ground);
    return foot_points.column.volume(triangles);
  }
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.size(); ++t) {
    sum += prism_volume(triangles.corners.col(t), triangles.shares.col(t), x, foot_points);
  }
  return sum;
}

double layer_volume(const Eigen::Matrix3Xi& triangles, const Positions& x,
                    const FootPoints& foot_points, double thickness) {
  if (thickness == 0.0) return 0.0;
  const Positions& below = foot_points.are_flat ? x : foot_points.places;
  double sum = 0.0;  // 2 (A − A_p)
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const int i = triangles(0, t), j = triangles(1, t), k = triangles(2, t);
    const Eigen::Vector3d area = (x.col(j) - x.col(i)).cross(x.col(k) - x.col(i));
    const Eigen::Vector3d foot = (below.col(j) - below.col(i)).cross(below.col(k) - below.col(i));
    const Eigen::Vector3d up =
        foot_points.normal(i) + foot_points.normal(j) + foot_points.normal(k);
    sum += area.norm() - foot.dot(up) / 3.0;
  }
  return 0.25 * thickness * sum;
}

void trapped_volume_gradient(const CoverTriangles& triangles, const Positions& x,
                             FootPoints& foot_points, Eigen::Matrix3Xd& gradient) {
  if (foot_points.are_flat) {
    foot_points.column.place(x, foot_points.ground);
    foot_points.column.gradient(triangles, gradient);
    return;
  }
  gradient.setZero(3, x.cols());
  for (Eigen::Index t = 0; t < triangles.size(); ++t) {
    const Eigen::Vector3i v = triangles.corners.col(t);
    const Eigen::Vector3d area = (x.col(v[1]) - x.col(v[0])).cross(x.col(v[2]) - x.col(v[0])) / 2.0;
    for (int k = 0; k < 3; ++k) gradient.col(v[k]) += triangles.shares(k, t) * area;
  }
}

}  // namespace pliant
