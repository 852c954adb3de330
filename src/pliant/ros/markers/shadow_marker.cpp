#include "pliant/ros/markers/shadow_marker.h"

#include <algorithm>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/ros/conversions.h"
#include "pliant/ros/markers/shading.h"
#include "pliant/ros/markers/surface_marker.h"

namespace pliant {
namespace {

constexpr double kLift = 2e-4;       // above the table, below what lies on it [m]
constexpr double kPlaneHalf = 1.0;   // of the plate that shows a plane [m]
constexpr double kLevel = 0.9999;    // least z of the normal of what counts as level
constexpr float kBrightness = 0.7f;  // over that of the table beside it

using Polygon = std::vector<Eigen::Vector3d>;

/// The part of a polygon where sign * its coordinate `axis` is at most `most`.
Polygon cut(const Polygon& polygon, int axis, double sign, double most) {
  Polygon rest;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector3d& a = polygon[k];
    const Eigen::Vector3d& b = polygon[(k + 1) % polygon.size()];
    const double beyond_a = sign * a[axis] - most, beyond_b = sign * b[axis] - most;
    if (beyond_a <= 0.0) rest.push_back(a);
    if ((beyond_a < 0.0) != (beyond_b < 0.0) && beyond_a != beyond_b) {
      rest.push_back(a + beyond_a / (beyond_a - beyond_b) * (b - a));
    }
  }
  return rest;
}

}  // namespace

ShadowMarker::ShadowMarker(const World& world) {
  const std::vector<Obstacle>& obstacles = world.obstacles();
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    const Obstacle& obstacle = obstacles[o];
    const auto* box = as<Box>(*obstacle.shape);
    const bool is_plane = as<Plane>(*obstacle.shape) != nullptr;
    if (obstacle.link.empty() && (box != nullptr || is_plane)) {
      const Eigen::Vector3d half =
          is_plane ? Eigen::Vector3d(kPlaneHalf, kPlaneHalf, 0.0) : (0.5 * box->size()).eval();
      const float bright = solid_brightness(Eigen::Vector3d::UnitZ());
      tables_.push_back(
          {o, half.head<2>(), half.z(), kBrightness * bright * obstacle.color.head<3>()});
    }
    if (!is_plane && !obstacle.liquid) casters_.push_back({o, obstacle.shape->surface()});
  }
  for (const Body& body : world.bodies()) {
    bodies_.push_back({{}, body.model->surface_triangles()});
    body_is_solid_.push_back(is_drawn_solid(*body.model));
  }
  marker_.ns = "shadows";
  marker_.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker_.pose.orientation.w = 1.0;
  marker_.scale.x = marker_.scale.y = marker_.scale.z = 1.0;
  marker_.color = to_color(Eigen::Vector3f(1.0f, 1.0f, 1.0f));
}

void ShadowMarker::sort_tables(const Snapshot& snapshot) {
  const auto height = [&](const Table& table) {
    return snapshot.obstacle_poses[table.obstacle].translation().z() + table.top;
  };
  std::stable_sort(tables_.begin(), tables_.end(),
                   [&](const Table& a, const Table& b) { return height(a) > height(b); });
}

/// On the highest table below it that some of it falls on. `corners`: columns, in the world.
void ShadowMarker::add_triangle(const Eigen::Matrix3d& corners, const Snapshot& snapshot) {
  for (const Table& table : tables_) {
    const Eigen::Isometry3d& pose = snapshot.obstacle_poses[table.obstacle];
    if (pose.linear()(2, 2) < kLevel) continue;
    const double z = pose.translation().z() + table.top;
    if (corners.row(2).minCoeff() <= z) continue;
    Polygon shadow;  // in the table's frame
    for (int k = 0; k < 3; ++k) {
      const double height = corners(2, k) - z - kLift;
      shadow.emplace_back(pose.inverse() * (corners.col(k) - height / to_light().z() * to_light()));
    }
    for (const int axis : {0, 1}) {
      for (const double sign : {1.0, -1.0}) shadow = cut(shadow, axis, sign, table.half[axis]);
    }
    if (shadow.empty()) continue;
    for (std::size_t k = 2; k < shadow.size(); ++k) {
      for (const std::size_t i : {std::size_t{0}, k - 1, k}) {
        marker_.points.push_back(to_point(pose * shadow[i]));
        marker_.colors.push_back(to_color(table.color));
      }
    }
    return;
  }
}

/// Of a closed surface the part that faces the light casts the whole shadow.
void ShadowMarker::add_mesh(const TriangleMesh& mesh, bool is_solid, const Snapshot& snapshot) {
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = mesh.vertices.col(mesh.triangles(k, t));
    const Eigen::Vector3d normal =
        (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
    if (!is_solid || normal.dot(to_light()) > 0.0) add_triangle(corners, snapshot);
  }
}

const visualization_msgs::Marker& ShadowMarker::update(const Snapshot& snapshot) {
  marker_.header = snapshot.header;
  marker_.points.clear();
  marker_.colors.clear();
  sort_tables(snapshot);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const BodySnapshot& body = snapshot.bodies[b];
    if (body.surface_changes) bodies_[b].triangles = body.surface_triangles;
    bodies_[b].vertices = body.surface;
    add_mesh(bodies_[b], body_is_solid_[b], snapshot);
  }
  for (const Caster& caster : casters_) {
    const Eigen::Isometry3d& pose = snapshot.obstacle_poses[caster.obstacle];
    add_mesh({pose * caster.mesh.vertices, caster.mesh.triangles}, true, snapshot);
  }
  marker_.action =
      marker_.points.empty() ? visualization_msgs::Marker::DELETE : visualization_msgs::Marker::ADD;
  return marker_;
}

}  // namespace pliant
