#include "pliant/ros/markers/mark_messages.h"

#include <algorithm>

#include "pliant/ros/conversions.h"
#include "pliant/ros/markers/obstacle_marker.h"

namespace pliant {
namespace {

using visualization_msgs::Marker;

constexpr double kGravity = 9.81;       // [m/s^2]
constexpr double kMinArrow = 0.02;      // shortest arrow over the bodies' size
constexpr double kContactSize = 0.008;  // over the bodies' size
constexpr double kFixedSize = 0.015;    // over the bodies' size

Marker make_marker(const std::string& space, int type, const Eigen::Vector3f& color) {
  Marker marker;
  marker.ns = space;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.color = to_color(color);
  return marker;
}

}  // namespace

MarkMessages::MarkMessages(const World& world, bool show_robot) : obstacles_(world.obstacles()) {
  for (const Obstacle& obstacle : obstacles_) {
    obstacle_is_shown_.push_back(show_robot || obstacle.link.empty());
  }
  Eigen::AlignedBox3d box;
  double mass = 0.0;
  for (const Body& body : world.bodies()) {
    for (int i = 0; i < body.particles().size(); ++i) box.extend(body.particles().x.col(i));
    mass += body.particles().mass.sum();
  }
  size_ = box.diagonal().norm();
  weight_ = mass * kGravity;
}

void MarkMessages::add(const Snapshot& snapshot, Marker marker) {
  marker.header = snapshot.header;
  array_.markers.push_back(std::move(marker));
}

void MarkMessages::add_obstacles(const Snapshot& snapshot, bool everything) {
  const bool first = sent_poses_.empty();
  if (first) sent_poses_ = snapshot.obstacle_poses;
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const Eigen::Isometry3d& pose = snapshot.obstacle_poses[o];
    const bool moved = pose.matrix() != sent_poses_[o].matrix();
    if (!obstacle_is_shown_[o] || !(first || everything || moved)) continue;
    sent_poses_[o] = pose;
    Marker marker = obstacle_marker(obstacles_[o], pose);
    marker.id = static_cast<int>(o);
    add(snapshot, std::move(marker));
  }
}

void MarkMessages::add_forces(const Snapshot& snapshot) {
  Marker arrow = make_marker("applied_forces", Marker::ARROW, {0.95f, 0.75f, 0.1f});
  arrow.scale.x = 0.015 * size_;  // shaft
  arrow.scale.y = 0.03 * size_;   // head
  arrow.points.resize(2);
  for (const Snapshot::AppliedForceMark& mark : snapshot.forces) {
    // Grows with the force, and stays in the picture however great that is.
    const double norm = mark.force.stableNorm();
    const double length = size_ * std::max(kMinArrow, 0.5 * norm / (norm + weight_));
    if (!(norm > 0.0)) continue;
    arrow.points[0] = to_point(mark.point);
    arrow.points[1] = to_point(mark.point + length * mark.force.stableNormalized());
    add(snapshot, arrow);
    ++arrow.id;
  }
  const auto shown = static_cast<std::size_t>(arrow.id);
  arrow.action = Marker::DELETE;
  for (; arrow.id < static_cast<int>(forces_shown_); ++arrow.id) add(snapshot, arrow);
  forces_shown_ = shown;
}

void MarkMessages::add_list(const Snapshot& snapshot, const std::vector<Eigen::Vector3d>& points,
                            Marker marker, bool& shown) {
  if (points.empty() && !shown) return;
  if (points.empty()) marker.action = Marker::DELETE;
  for (const Eigen::Vector3d& point : points) marker.points.push_back(to_point(point));
  shown = !points.empty();
  add(snapshot, std::move(marker));
}

const visualization_msgs::MarkerArray& MarkMessages::update(const Snapshot& snapshot,
                                                            bool everything) {
  array_.markers.clear();
  add_obstacles(snapshot, everything);
  add_forces(snapshot);
  Marker contacts = make_marker("contacts", Marker::POINTS, {0.9f, 0.1f, 0.1f});
  contacts.scale.x = contacts.scale.y = kContactSize * size_;
  add_list(snapshot, snapshot.contacts, std::move(contacts), contacts_shown_);
  Marker fixed = make_marker("fixed_vertices", Marker::SPHERE_LIST, {0.1f, 0.1f, 0.1f});
  fixed.scale.x = fixed.scale.y = fixed.scale.z = kFixedSize * size_;
  add_list(snapshot, snapshot.fixed, std::move(fixed), fixed_shown_);
  Marker held = make_marker("attachments", Marker::SPHERE_LIST, {0.55f, 0.15f, 0.75f});
  held.scale.x = held.scale.y = held.scale.z = kFixedSize * size_;
  add_list(snapshot, snapshot.held, std::move(held), held_shown_);
  return array_;
}

}  // namespace pliant
