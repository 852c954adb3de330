#include "pliant/ros/interactive/interactive_messages.h"

#include "pliant/math/shortest_turn.h"
#include "pliant/ros/conversions.h"

namespace pliant {
namespace {

using visualization_msgs::InteractiveMarker;
using visualization_msgs::InteractiveMarkerControl;
using visualization_msgs::Marker;

// rviz warns of markers that are wholly transparent.
constexpr float kUnseen = 0.01f;

InteractiveMarker empty_marker(const std::string& name, const std::string& frame) {
  InteractiveMarker marker;
  marker.header.frame_id = frame;
  marker.name = name;
  marker.pose.orientation.w = 1.0;
  marker.scale = 1.0f;
  return marker;
}

Marker shape(int type, const std_msgs::ColorRGBA& color) {
  Marker marker;
  marker.type = type;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = color;
  return marker;
}

void add_menu(const std::vector<MenuLine>& menu, InteractiveMarker& marker) {
  for (const MenuLine& line : menu) {
    visualization_msgs::MenuEntry entry;
    entry.id = line.id;
    entry.parent_id = line.parent;
    entry.title = line.title;
    entry.command_type = visualization_msgs::MenuEntry::FEEDBACK;
    marker.menu_entries.push_back(entry);
  }
}

/// A control that moves along, or turns about, one axis of the marker.
InteractiveMarkerControl axis_control(int axis, bool turns) {
  InteractiveMarkerControl control;
  control.name = std::string(turns ? "turn_" : "move_") + "xyz"[axis];
  control.interaction_mode =
      turns ? InteractiveMarkerControl::ROTATE_AXIS : InteractiveMarkerControl::MOVE_AXIS;
  // rviz moves along the control's own x axis.
  const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
  const Eigen::Quaterniond turn = shortest_turn(Eigen::Vector3d::UnitX(), direction);
  control.orientation.w = turn.w();
  control.orientation.x = turn.x();
  control.orientation.y = turn.y();
  control.orientation.z = turn.z();
  return control;
}

}  // namespace

InteractiveMarker surface_to_drag(const std::string& name, const std::string& frame,
                                  const TriangleMesh& surface, const std::vector<MenuLine>& menu) {
  InteractiveMarker marker = empty_marker(name, frame);
  add_menu(menu, marker);
  Marker mesh = shape(Marker::TRIANGLE_LIST, to_color(Eigen::Vector3f(1.0f, 1.0f, 1.0f), kUnseen));
  mesh.points.reserve(static_cast<std::size_t>(surface.triangles.size()));
  for (Eigen::Index k = 0; k < surface.triangles.size(); ++k) {
    mesh.points.push_back(to_point(surface.vertices.col(surface.triangles.data()[k])));
  }
  InteractiveMarkerControl control;
  control.name = "surface";
  control.interaction_mode = InteractiveMarkerControl::MOVE_3D;
  control.orientation.w = 1.0;
  control.always_visible = true;
  control.description = "drag with the left button; menu on the right one";
  control.markers.push_back(std::move(mesh));
  marker.controls.push_back(std::move(control));
  return marker;
}

InteractiveMarker spring_line(const std::string& name, const std::string& frame,
                              const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                              double width) {
  InteractiveMarker marker = empty_marker(name, frame);
  const std_msgs::ColorRGBA color = to_color(Eigen::Vector3f(1.0f, 0.8f, 0.1f));
  Marker line = shape(Marker::LINE_LIST, color), end = shape(Marker::SPHERE_LIST, color);
  line.scale.x = width;
  line.points = {to_point(from), to_point(to)};
  end.scale.x = end.scale.y = end.scale.z = 5.0 * width;
  end.points = line.points;
  InteractiveMarkerControl control;
  control.name = "spring";
  control.interaction_mode = InteractiveMarkerControl::NONE;
  control.orientation.w = 1.0;
  control.always_visible = true;
  control.markers = {line, end};
  marker.controls.push_back(std::move(control));
  return marker;
}

InteractiveMarker hand_to_drag(const std::string& name, const std::string& frame,
                               const Eigen::Isometry3d& pose, double size, bool can_turn,
                               const std::vector<MenuLine>& menu) {
  InteractiveMarker marker = empty_marker(name, frame);
  marker.pose = to_pose(pose);
  marker.scale = static_cast<float>(size);
  add_menu(menu, marker);
  InteractiveMarkerControl middle;
  middle.name = "menu";
  middle.interaction_mode = InteractiveMarkerControl::MOVE_3D;
  middle.orientation.w = 1.0;
  middle.always_visible = true;
  Marker ball = shape(Marker::SPHERE, to_color(Eigen::Vector3f(1.0f, 0.8f, 0.1f), 0.6f));
  ball.scale.x = ball.scale.y = ball.scale.z = 0.3 * size;
  middle.markers.push_back(ball);
  marker.controls.push_back(std::move(middle));
  for (int axis = 0; axis < 3; ++axis) {
    marker.controls.push_back(axis_control(axis, false));
    if (can_turn) marker.controls.push_back(axis_control(axis, true));
  }
  return marker;
}

}  // namespace pliant
