#include "pliant/ros/model_node.h"

#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <ros/spinner.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/error.h"
#include "pliant/ros/conversions.h"
#include "pliant/ros/interactive/interactive_markers.h"
#include "pliant/ros/markers/body_colors.h"
#include "pliant/ros/running/master_watch.h"
#include "pliant/ros/running/what_runs.h"
#include "pliant/ros/services.h"

namespace pliant {
namespace {

// Services that wait for long (~step) leave threads for others.
constexpr int kServiceThreads = 6;

struct RobotDescription {
  std::optional<std::string> description;  // URDF
  bool use_joint_states = false;
};

RobotDescription find_robot(const NodeParameters& parameters) {
  RobotDescription input;
  std::string key;
  std::string urdf;
  input.description = parameters.robot_description;
  if (!input.description && ros::NodeHandle().searchParam("robot_description", key) &&
      ros::param::get(key, urdf)) {
    input.description = urdf;
  }
  input.use_joint_states = parameters.use_joint_states.value_or(input.description.has_value());
  if (!input.use_joint_states) input.description.reset();
  return input;
}

LoadedScene load(const NodeParameters& parameters, const RobotDescription& robot) {
  SceneOverrides overrides;
  overrides.solver = parameters.solver;
  overrides.time_integration = parameters.time_integration;
  overrides.backend = parameters.backend;
  overrides.time_step = parameters.time_step;
  overrides.threads = parameters.threads;
  overrides.usual_threads = usual_threads();
  overrides.robot_description = robot.description;
  overrides.drive_robot_from_keyframes = !robot.use_joint_states;
  overrides.knows_tf = true;
  LoadedScene scene = load_scene(parameters.scene, overrides);
  for (const std::string& note : scene.notes) ROS_INFO("%s", note.c_str());
  for (const std::string& warning : scene.warnings) ROS_WARN("%s", warning.c_str());
  color_apart(scene);
  if (parameters.use_joint_states.value_or(false) && scene.robots.empty()) {
    throw InputError("~use_joint_states is true, but there is no robot in " + parameters.scene);
  }
  if (parameters.publish_robot_tf.value_or(false) && scene.robots.empty()) {
    throw InputError("~publish_robot_tf is true, but there is no robot in " + parameters.scene);
  }
  return scene;
}

/// What users drag the scene's robots by. Their keyframes then go through it.
Hands hands_of(const NodeParameters& parameters, LoadedScene& scene, bool use_joint_states) {
  Hands hands;
  if (!use_joint_states) return make_hands(scene, parameters.hand_link);
  hands.why_not.emplace_back(
      "the robot follows joint_states, so that its hand is not dragged here: drag it where they "
      "come from, or set use_joint_states to false");
  return hands;
}

/// Everything a running node consists of; made in this order, stopped in the reverse one.
class ModelNode {
 public:
  explicit ModelNode(const NodeParameters& parameters)
      : robot_(find_robot(parameters)),
        frames_(parameters.frame_id),
        scene_(load(parameters, robot_)),
        uses_joint_states_(robot_.use_joint_states && !scene_.robots.empty()),
        hands_(hands_of(parameters, scene_, uses_joint_states_)),
        robots_(std::make_shared<RobotInput>(scene_, uses_joint_states_, parameters.publish_clock,
                                             frames_)),
        show_robot_(parameters.show_robot.value_or(!robot_.description)),
        simulation_(std::move(scene_), robots_, parameters),
        publications_(private_node_, parameters, show_robot_, simulation_) {
    ROS_INFO("%s",
             what_runs(simulation_, publications_.topics(), private_node_.getNamespace()).c_str());
    subscribe_to_joints();
    if (parameters.publish_robot_base) publish_robot_base(parameters);
  }

  void run(const NodeParameters& parameters) {
    SimulationThread thread(simulation_, publications_);
    Services services(private_node_, frames_, thread);
    InteractiveMarkers markers(private_node_, parameters, thread, hands_);
    const MasterWatch watch(services.names(), parameters.publish_clock, simulation_.notices());
    ros::AsyncSpinner services_spinner(kServiceThreads);
    ros::AsyncSpinner joints_spinner(1, &joints_queue_);
    services_spinner.start();
    joints_spinner.start();
    ros::waitForShutdown();
    // First of all, since the spinners wait for callbacks that wait for answers.
    thread.stop();
  }

 private:
  void subscribe_to_joints() {
    if (!uses_joint_states_) return;
    // A queue of its own, so that a flood of requests does not hold up the robot.
    joints_node_.setCallbackQueue(&joints_queue_);
    joints_subscriber_ =
        joints_node_.subscribe("joint_states", 10, &RobotInput::on_message, robots_.get());
  }

  /// Once: tf keeps what is static for whoever comes later. Of a robot that follows a frame of tf,
  /// others say where it is.
  void publish_robot_base(const NodeParameters& parameters) {
    if (simulation_.link_names().empty()) {
      throw InputError("~publish_robot_base is true, but there is no robot in " + parameters.scene);
    }
    std::vector<geometry_msgs::TransformStamped> bases;
    for (const PlacedFrame& root : simulation_.standing_roots()) {
      geometry_msgs::TransformStamped base;
      base.header.stamp = simulation_.now();
      base.header.frame_id = parameters.frame_id;
      base.child_frame_id = root.name;
      const geometry_msgs::Pose pose = to_pose(root.pose);
      base.transform.translation = to_vector3(to_vector(pose.position));
      base.transform.rotation = pose.orientation;
      bases.push_back(base);
    }
    base_broadcaster_ = std::make_unique<tf2_ros::StaticTransformBroadcaster>();
    base_broadcaster_->sendTransform(bases);
  }

  ros::NodeHandle private_node_{"~"};
  ros::NodeHandle joints_node_;
  ros::CallbackQueue joints_queue_;
  RobotDescription robot_;
  FrameTransformer frames_;
  LoadedScene scene_;
  bool uses_joint_states_;
  Hands hands_;
  std::shared_ptr<RobotInput> robots_;
  bool show_robot_;
  Simulation simulation_;
  Publications publications_;
  ros::Subscriber joints_subscriber_;
  std::unique_ptr<tf2_ros::StaticTransformBroadcaster> base_broadcaster_;  // null without
};

/// The node takes no arguments of its own but --help; ros::init() has removed those of ROS.
int answer_arguments(int argc, char** argv, const std::string& name, const std::string& scene) {
  const std::string first = argv[1];
  const std::string usage =
      fmt::format("usage: {}_node [--help] [_PARAMETER:=VALUE...]\n\nPrivate parameters:\n{}", name,
                  describe_parameters(node_parameter_specs(scene)));
  if (argc == 2 && (first == "--help" || first == "-h")) {
    fmt::print("{}", usage);
    return 0;
  }
  fmt::print(stderr, "{}_node: unknown argument '{}'\n{}", name, first, usage);
  return 2;
}

}  // namespace

int run_model_node(int argc, char** argv, const std::string& name, const std::string& scene_file) {
  ros::init(argc, argv, name);
  const std::string scene =
      scene_file.empty() ? "" : ros::package::getPath("pliant") + "/config/scenes/" + scene_file;
  if (argc > 1) return answer_arguments(argc, argv, name, scene);
  ros::NodeHandle node;  // keeps the node alive while it loads
  try {
    const NodeParameters parameters = read_node_parameters(ros::NodeHandle("~"), scene);
    ModelNode(parameters).run(parameters);
  } catch (const InputError& error) {
    ROS_FATAL("%s", error.what());
    return 2;
  }
  return 0;
}

}  // namespace pliant
