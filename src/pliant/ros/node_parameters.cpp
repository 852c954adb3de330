#include "pliant/ros/node_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "pliant/math/error.h"

namespace pliant {
namespace {

/// Empty when the text is the word for "decide yourself".
std::optional<bool> optional_flag(const std::string& text) {
  if (text == "auto") return {};
  return text == "true";
}

std::string to_text(XmlRpc::XmlRpcValue& value, const std::string& name) {
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return static_cast<bool>(value) ? "true" : "false";
    case XmlRpc::XmlRpcValue::TypeInt:
      return std::to_string(static_cast<int>(value));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return fmt::format("{}", static_cast<double>(value));
    case XmlRpc::XmlRpcValue::TypeString:
      return static_cast<std::string>(value);
    default:
      throw InputError("parameter '" + name + "' must be a number, a text, or true or false");
  }
}

ParameterText private_parameter_text(const ros::NodeHandle& node) {
  ParameterText text;
  XmlRpc::XmlRpcValue all;
  if (!node.getParam(node.getNamespace(), all)) return text;
  if (all.getType() != XmlRpc::XmlRpcValue::TypeStruct) return text;
  for (auto& [name, value] : all) {
    const std::string written = to_text(value, node.getNamespace() + "/" + name);
    if (!written.empty()) text[name] = written;
  }
  return text;
}

ParameterSpec text_parameter(std::string name, std::string default_value, std::string meaning) {
  return choice_parameter(std::move(name), std::move(default_value), {}, std::move(meaning));
}

ParameterSpec rate_parameter(std::string name, std::string default_value, std::string meaning) {
  return number_parameter(std::move(name), "Hz", std::move(default_value), 0.0, 1000.0,
                          std::move(meaning));
}

double real_time_limit(const Parameters& parameters) {
  const double limit = parameters.number("max_real_time_factor");
  const double unlimited = std::numeric_limits<double>::infinity();
  return std::min(limit > 0.0 ? limit : unlimited, parameters.flag("real_time") ? 1.0 : unlimited);
}

ColorBy read_color_by(const Parameters& given, const std::string& where) {
  const ColorBy by = {given.text("color_by"), given.number("color_min"), given.number("color_max"),
                      0.01 * given.number("color_outliers")};
  if (by.min > by.max) {
    throw InputError(fmt::format("{}: 'color_min' is {:g}, but must not be above 'color_max', {:g}",
                                 where, by.min, by.max));
  }
  return by;
}

}  // namespace

std::vector<ParameterSpec> node_parameter_specs(const std::string& scene) {
  return {
      text_parameter("scene", scene, "path of the scene file"),
      text_parameter("solver", "scene", "solver to use; 'scene' is the scene's own"),
      text_parameter("time_integration", "scene",
                     "time integration to use; 'scene' is the scene's own"),
      choice_parameter("backend", "scene", {"scene", "auto", "cpu", "cuda"},
                       "where solvers run; 'scene' is the scene's own"),
      number_parameter("time_step", "s", "0", 0.0, 10.0, "0 is the scene's own"),
      integer_parameter(
          "threads", "0", 0, 1024,
          "threads of a step; 0 is the scene's own, and 2 where it names none and the "
          "machine has them"),
      text_parameter("frame_id", "world", "frame that positions are in"),
      rate_parameter("surface_rate", "30",
                     "of all topics of surfaces, and of ~shadows; 0 switches them off"),
      rate_parameter("points_rate", "30", "of all topics of points; 0 switches them off"),
      rate_parameter("markers_rate", "10", "of ~markers; 0 switches it off"),
      rate_parameter("mesh_rate", "30", "of all topics mesh/points; 0 switches them off"),
      rate_parameter("contacts_rate", "30", "of ~contacts; 0 switches it off"),
      rate_parameter("wrenches_rate", "50",
                     "of ~contact_wrenches and all of ~wrench/; 0 switches them off"),
      rate_parameter("status_rate", "10", "of ~status; 0 switches it off"),
      rate_parameter("tf_rate", "30",
                     "of the tf frames of what moves: links, attachments; 0 switches these off"),
      flag_parameter("real_time", "true", "never faster than the wall clock"),
      number_parameter("max_real_time_factor", "", "0", 0.0, 1e6,
                       "simulated over wall time that is not exceeded; 0 sets no limit"),
      flag_parameter("paused", "false", "whether it starts paused"),
      flag_parameter("publish_clock", "false", "/clock and all stamps show simulated time"),
      choice_parameter(
          "use_joint_states", "auto", {"auto", "true", "false"},
          "the robot follows joint_states instead of the scene's keyframes; auto: when "
          "there is a robot_description"),
      text_parameter("robot_description", "auto",
                     "URDF text of the robot; auto: the parameter robot_description, looked for "
                     "from the node's namespace upwards"),
      number_parameter("joint_states_wait", "s", "5", 0.0, 1e6,
                       "how long the first step waits for the first joint_states, and for tf of "
                       "what robots follow (wall time)"),
      rate_parameter("interactive_rate", "5",
                     "of what the mouse can take hold of in rviz; 0 switches it off"),
      number_parameter("drag_radius", "m", "0.03", 0.0, 1e3,
                       "vertices within it are dragged together; 0: the nearest one"),
      number_parameter("drag_stiffness", "N/m", "0", 0.0, 1e12,
                       "of the spring between the mouse and what it drags; 0: by the body's mass"),
      number_parameter("drag_force_limit", "N", "0", 0.0, 1e12,
                       "the spring never pulls harder; 0: by the body's mass"),
      text_parameter("hand_link", "auto",
                     "link of the robot that is dragged, of several robots \"LINK, LINK\"; auto: "
                     "the one on which its fingers sit"),
      number_parameter("grip_force", "N", "5", 0.0, 1e6,
                       "at which fingers stop closing; 0: they close to their limits"),
      choice_parameter("publish_robot_tf", "auto", {"auto", "true", "false"},
                       "the node says in tf where the robots' links are; auto: where it does not "
                       "follow joint_states, which a robot_state_publisher follows too"),
      flag_parameter("publish_robot_base", "false",
                     "tf (static) from frame_id to each robot's root link, where the scene has it"),
      choice_parameter("show_robot", "auto", {"auto", "true", "false"},
                       "the robot's collision shapes are in ~markers; auto: when there is no "
                       "robot_description, which rviz would show by itself"),
      text_parameter("color_by", "none",
                     "what the bodies' colours show: none, speed, strain, stress, or a field "
                     "of ~points such as temperature"),
      number_parameter("color_min", "", "0", -1e30, 1e30, "of the quantity, shown dark blue"),
      number_parameter("color_max", "", "0", -1e30, 1e30,
                       "of the quantity, shown yellow; equal to color_min: the range follows "
                       "what occurs, and ~legend tells it"),
      number_parameter("color_outliers", "%", "5", 0.0, 49.0,
                       "of the values that a range which follows leaves out at each end, so that "
                       "a few peaks do not take the colours from the rest; 0: none, of all that "
                       "occurred so far"),
  };
}

Parameters read_private_parameters(const ros::NodeHandle& node,
                                   const std::vector<ParameterSpec>& specs) {
  return parse_parameters(specs, private_parameter_text(node), node.getNamespace());
}

NodeParameters read_node_parameters(const ros::NodeHandle& node, const std::string& scene) {
  const Parameters given = read_private_parameters(node, node_parameter_specs(scene));
  NodeParameters parameters;
  parameters.scene = given.text("scene");
  if (given.text("solver") != "scene") parameters.solver = given.text("solver");
  if (given.text("time_integration") != "scene") {
    parameters.time_integration = given.text("time_integration");
  }
  if (given.text("backend") != "scene") parameters.backend = given.text("backend");
  if (given.number("time_step") > 0.0) parameters.time_step = given.number("time_step");
  if (given.integer("threads") > 0) parameters.threads = given.integer("threads");
  parameters.frame_id = given.text("frame_id");
  parameters.surface_rate = given.number("surface_rate");
  parameters.points_rate = given.number("points_rate");
  parameters.markers_rate = given.number("markers_rate");
  parameters.mesh_rate = given.number("mesh_rate");
  parameters.contacts_rate = given.number("contacts_rate");
  parameters.wrenches_rate = given.number("wrenches_rate");
  parameters.tf_rate = given.number("tf_rate");
  parameters.status_rate = given.number("status_rate");
  parameters.real_time_limit = real_time_limit(given);
  parameters.paused = given.flag("paused");
  parameters.publish_clock = given.flag("publish_clock");
  parameters.use_joint_states = optional_flag(given.text("use_joint_states"));
  if (given.text("robot_description") != "auto") {
    parameters.robot_description = given.text("robot_description");
  }
  parameters.joint_states_wait = given.number("joint_states_wait");
  parameters.interactive_rate = given.number("interactive_rate");
  parameters.drag_radius = given.number("drag_radius");
  parameters.drag_stiffness = given.number("drag_stiffness");
  parameters.drag_force_limit = given.number("drag_force_limit");
  if (given.text("hand_link") != "auto") parameters.hand_link = given.text("hand_link");
  parameters.grip_force = given.number("grip_force");
  parameters.publish_robot_tf = optional_flag(given.text("publish_robot_tf"));
  parameters.publish_robot_base = given.flag("publish_robot_base");
  parameters.show_robot = optional_flag(given.text("show_robot"));
  parameters.color_by = read_color_by(given, node.getNamespace());
  return parameters;
}

}  // namespace pliant
