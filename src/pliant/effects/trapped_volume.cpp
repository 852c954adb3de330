#include "pliant/effects/trapped_volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

#include "pliant/geometry/primitive_shapes.h"

namespace pliant {
namespace {

/// From its foot to a vertex that is not below it.
Eigen::Vector3d rise(int i, const Positions& x, const Feet& feet) {
  const Eigen::Vector3d way = x.col(i) - feet.places.col(i), normal = feet.normals.col(i);
  return way - std::min(0.0, normal.dot(way)) * normal;
}

double prism_volume(const Eigen::Vector3i& t, const Positions& x, const Feet& feet) {
  const Eigen::Vector3d d0 = rise(t[0], x, feet), d1 = rise(t[1], x, feet),
                        d2 = rise(t[2], x, feet);
  const Eigen::Vector3d up = d0 + d1 + d2, q = feet.places.col(t[0]);
  const Eigen::Vector3d a = feet.places.col(t[1]) - q, b = feet.places.col(t[2]) - q;
  const Eigen::Vector3d u = d1 - d0, v = d2 - d0;
  const Eigen::Vector3d mean = a.cross(b) + 0.5 * (a.cross(v) + u.cross(b)) + u.cross(v) / 3.0;
  return mean.dot(up) / 6.0;
}

}  // namespace

FootFinder::FootFinder(const std::vector<Obstacle>& obstacles, std::vector<int> chosen)
    : obstacles_(obstacles), chosen_(std::move(chosen)) {
  const auto& first = obstacles[static_cast<std::size_t>(chosen_.front())].shape;
  is_plane_ = chosen_.size() == 1 && dynamic_cast<const Plane*>(first.get()) != nullptr;
}

void FootFinder::find(const Positions& x, double offset, Feet& feet) const {
  const auto n = x.cols();
  feet.are_flat = is_plane_;
  feet.nearest.assign(static_cast<std::size_t>(n), chosen_.front());
  if (is_plane_) {
    const Eigen::Isometry3d& pose = obstacles_[static_cast<std::size_t>(chosen_.front())].pose_end;
    const Eigen::Vector3d normal = pose.linear().col(2);
    feet.ground = {normal, normal.dot(pose.translation()) + offset};
    heights_above(x, feet.ground, feet.heights);
    return;
  }
  feet.places.resize(3, n);
  feet.normals.resize(3, n);
  feet.heights.setConstant(n, std::numeric_limits<double>::infinity());
  for (const int o : chosen_) {
    const Obstacle& obstacle = obstacles_[static_cast<std::size_t>(o)];
    const Eigen::Isometry3d local = obstacle.pose_end.inverse();
    for (int i = 0; i < n; ++i) {
      const SurfacePoint surface = obstacle.shape->query(local * x.col(i));
      const double height = surface.distance - offset;
      if (!(height < feet.heights[i])) continue;
      feet.heights[i] = height;
      feet.normals.col(i) = obstacle.pose_end.linear() * surface.normal;
      feet.nearest[static_cast<std::size_t>(i)] = o;
    }
  }
  for (int i = 0; i < n; ++i) {
    feet.places.col(i) = x.col(i) - feet.heights[i] * feet.normals.col(i);
  }
  feet.heights = feet.heights.cwiseMax(0.0);
}

double trapped_volume(const Eigen::Matrix3Xi& triangles, const Positions& x, Feet& feet) {
  if (feet.are_flat) {
    feet.column.place(x, feet.ground);
    return feet.column.volume(triangles);
  }
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    sum += prism_volume(triangles.col(t), x, feet);
  }
  return sum;
}

double layer_volume(const Eigen::Matrix3Xi& triangles, const Positions& x, const Feet& feet,
                    double thickness) {
  if (thickness == 0.0) return 0.0;
  const Positions& below = feet.are_flat ? x : feet.places;
  double sum = 0.0;  // 2 (A − A_p)
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const int i = triangles(0, t), j = triangles(1, t), k = triangles(2, t);
    const Eigen::Vector3d area = (x.col(j) - x.col(i)).cross(x.col(k) - x.col(i));
    const Eigen::Vector3d foot = (below.col(j) - below.col(i)).cross(below.col(k) - below.col(i));
    const Eigen::Vector3d up = feet.normal(i) + feet.normal(j) + feet.normal(k);
    sum += area.norm() - foot.dot(up) / 3.0;
  }
  return 0.25 * thickness * sum;
}

void trapped_volume_gradient(const Eigen::Matrix3Xi& triangles, const Positions& x, Feet& feet,
                             Eigen::Matrix3Xd& gradient) {
  if (feet.are_flat) {
    feet.column.place(x, feet.ground);
    feet.column.gradient(triangles, gradient);
    return;
  }
  gradient.setZero(3, x.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3i v = triangles.col(t);
    const Eigen::Vector3d third =
        (x.col(v[1]) - x.col(v[0])).cross(x.col(v[2]) - x.col(v[0])) / 6.0;
    for (int k = 0; k < 3; ++k) gradient.col(v[k]) += third;
  }
}

}  // namespace pliant
