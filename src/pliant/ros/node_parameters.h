#pragma once

#include <ros/node_handle.h>

#include <optional>
#include <string>
#include <vector>

#include "pliant/core/parameters.h"
#include "pliant/ros/markers/color_by.h"

namespace pliant {

/// The private parameters of `node`, checked against `specs`. An empty text counts as not given.
/// Throws InputError for an unknown parameter (with the nearest name), a type or a value that is
/// not allowed.
Parameters read_private_parameters(const ros::NodeHandle& node,
                                   const std::vector<ParameterSpec>& specs);

/// The private parameters of a model node. A rate of 0 switches its topic off.
struct NodeParameters {
  std::string scene;                            ///< path of the scene file
  std::optional<std::string> solver;            ///< instead of the scene's
  std::optional<std::string> time_integration;  ///< instead of the scene's
  std::optional<std::string> backend;           ///< instead of those of the scene's solvers
  std::optional<double> time_step;              ///< instead of the scene's [s]
  std::optional<int> threads;                   ///< instead of the scene's
  std::string frame_id;                         ///< frame that positions are in
  double surface_rate = 0.0;                    ///< [Hz]
  double points_rate = 0.0;                     ///< [Hz]
  double markers_rate = 0.0;                    ///< [Hz]
  double mesh_rate = 0.0;                       ///< [Hz]
  double contacts_rate = 0.0;                   ///< [Hz]
  double wrenches_rate = 0.0;                   ///< [Hz]
  double tf_rate = 0.0;                         ///< [Hz]
  double status_rate = 0.0;                     ///< [Hz]
  double real_time_limit = 0.0;          ///< real-time factor that is not exceeded; infinite: none
  bool paused = false;                   ///< at the start
  bool publish_clock = false;            ///< /clock shows simulated time
  std::optional<bool> use_joint_states;  ///< empty: when robot_description is there
  std::optional<std::string> robot_description;  ///< URDF; empty: the parameter of that name
  std::optional<bool> publish_robot_tf;          ///< empty: where the node drives the robot
  double joint_states_wait = 0.0;  ///< how long the first step waits for joint states [s]
  double interactive_rate = 0.0;   ///< of what can be taken hold of in rviz [Hz]; 0: off
  double drag_radius = 0.0;        ///< vertices within it are dragged together [m]
  double drag_stiffness = 0.0;     ///< [N/m]; 0: by the body's mass
  double drag_force_limit = 0.0;   ///< [N]; 0: by the body's mass
  std::string hand_link;           ///< of the robot, which is dragged; "": found
  double grip_force = 0.0;         ///< at which fingers stop closing [N]
  ColorBy color_by;
  bool publish_robot_base = false;  ///< tf from frame_id to the root links of robots
  std::optional<bool> show_robot;   ///< collision shapes in ~markers; empty: without RobotModel
};

/// Names, units, ranges, defaults and meanings of the above. `scene`: the path of the scene that a
/// node runs which is given none; empty: it has to be given one.
std::vector<ParameterSpec> node_parameter_specs(const std::string& scene);

/// Throws InputError as read_private_parameters() does.
NodeParameters read_node_parameters(const ros::NodeHandle& node, const std::string& scene);

}  // namespace pliant
