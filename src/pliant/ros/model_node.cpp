#include "pliant/ros/model_node.h"

#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <ros/spinner.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "pliant/math/error.h"
#include "pliant/ros/body_colors.h"
#include "pliant/ros/conversions.h"
#include "pliant/ros/interactive_markers.h"
#include "pliant/ros/master_watch.h"
#include "pliant/ros/services.h"
#include "pliant/ros/what_runs.h"
#include "pliant/scene/keyframe_file.h"
#include "pliant/scene/keyframes.h"
#include "pliant/scene/place_error.h"

namespace pliant {
namespace {

// Services that wait for long (~step) leave threads for others.
constexpr int kServiceThreads = 6;

struct RobotInput {
  std::optional<std::string> description;  // URDF
  bool use_joint_states = false;
};

RobotInput find_robot(const NodeParameters& parameters) {
  RobotInput input;
  std::string key;
  std::string urdf;
  if (ros::NodeHandle().searchParam("robot_description", key) && ros::param::get(key, urdf)) {
    input.description = urdf;
  }
  input.use_joint_states = parameters.use_joint_states.value_or(input.description.has_value());
  if (!input.use_joint_states) input.description.reset();
  return input;
}

LoadedScene load(const NodeParameters& parameters, const RobotInput& robot) {
  SceneOverrides overrides;
  overrides.solver = parameters.solver;
  overrides.backend = parameters.backend;
  overrides.time_step = parameters.time_step;
  overrides.threads = parameters.threads;
  overrides.robot_description = robot.description;
  // A hand that a user may take moves it.
  overrides.drive_robot_from_keyframes = false;
  overrides.package_resolver = [](const std::string& name) { return ros::package::getPath(name); };
  LoadedScene scene = load_scene(parameters.scene, overrides);
  for (const std::string& warning : scene.warnings) ROS_WARN("%s", warning.c_str());
  color_apart(scene);
  if (parameters.use_joint_states.value_or(false) && !scene.robot) {
    throw InputError("~use_joint_states is true, but there is no robot in " + parameters.scene);
  }
  if (parameters.publish_robot_tf.value_or(false) && !scene.robot) {
    throw InputError("~publish_robot_tf is true, but there is no robot in " + parameters.scene);
  }
  return scene;
}

/// What users drag the robot by; null where they cannot. Also moves it as the keyframes say.
std::unique_ptr<HandControl> make_hand(const NodeParameters& parameters, LoadedScene& scene) {
  std::shared_ptr<JointSource> keyframes;
  const RobotSpec& spec = *scene.spec.robot;
  const std::string& path = spec.keyframes_path;
  if (!path.empty()) {
    keyframes = with_place(spec.keyframes_place.text() + ": robot.keyframes", [&] {
      return make_keyframe_source(read_keyframes(path, scene.robot.get()), *scene.robot, path);
    });
  }
  auto hand = HandControl::make(scene.robot, keyframes, parameters.hand_link, *scene.world);
  if (!keyframes) return hand;
  auto driver = hand ? hand->make_driver() : std::make_unique<RobotDriver>(scene.robot, keyframes);
  scene.driver = driver.get();
  scene.world->add_driver(std::move(driver));
  return hand;
}

std::string why_no_hand(const LoadedScene& scene, bool use_joint_states) {
  if (!scene.robot) return "";
  if (use_joint_states) {
    return "the robot follows joint_states, so that its hand is not dragged here: drag it where "
           "they come from, or set use_joint_states to false";
  }
  return "the robot's links branch where none is moved by a joint, so that no hand was found: name "
         "one by hand_link to drag it";
}

/// Everything a running node consists of; made in this order, stopped in the reverse one.
class ModelNode {
 public:
  explicit ModelNode(const NodeParameters& parameters)
      : robot_(find_robot(parameters)),
        scene_(load(parameters, robot_)),
        joints_(robot_.use_joint_states && scene_.robot
                    ? std::make_shared<JointStateSource>(scene_.robot)
                    : nullptr),
        hand_(scene_.robot && !joints_ ? make_hand(parameters, scene_) : nullptr),
        why_no_hand_(why_no_hand(scene_, joints_ != nullptr)),
        robot_links_(scene_.robot ? scene_.robot->link_names() : std::vector<std::string>()),
        robot_model_(scene_.robot),
        show_robot_(parameters.show_robot.value_or(!robot_.description)),
        simulation_(std::move(scene_), joints_, parameters),
        publications_(private_node_, parameters, show_robot_, simulation_) {
    ROS_INFO("%s",
             what_runs(simulation_, publications_.topics(), private_node_.getNamespace()).c_str());
    subscribe_to_joints();
    if (parameters.publish_robot_base) publish_robot_base(parameters);
  }

  void run(const NodeParameters& parameters) {
    SimulationThread thread(simulation_, publications_);
    Services services(private_node_, parameters.frame_id, robot_links_, thread);
    InteractiveMarkers markers(private_node_, parameters, thread, hand_.get(), why_no_hand_);
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
    if (!joints_) return;
    // A queue of its own, so that a flood of requests does not hold up the robot.
    joints_node_.setCallbackQueue(&joints_queue_);
    joints_subscriber_ =
        joints_node_.subscribe("joint_states", 10, &JointStateSource::on_message, joints_.get());
  }

  /// Once: tf keeps what is static for whoever comes later.
  void publish_robot_base(const NodeParameters& parameters) {
    if (!robot_model_) {
      throw InputError("~publish_robot_base is true, but there is no robot in " + parameters.scene);
    }
    const std::string& root = robot_model_->link_names().front();
    geometry_msgs::TransformStamped base;
    base.header.stamp = simulation_.now();
    base.header.frame_id = parameters.frame_id;
    base.child_frame_id = root;
    const geometry_msgs::Pose pose =
        to_pose(robot_model_->link_pose(root, robot_model_->initial_positions()));
    base.transform.translation = to_vector3(to_vector(pose.position));
    base.transform.rotation = pose.orientation;
    base_broadcaster_ = std::make_unique<tf2_ros::StaticTransformBroadcaster>();
    base_broadcaster_->sendTransform(base);
  }

  ros::NodeHandle private_node_{"~"};
  ros::NodeHandle joints_node_;
  ros::CallbackQueue joints_queue_;
  RobotInput robot_;
  LoadedScene scene_;
  std::shared_ptr<JointStateSource> joints_;
  std::unique_ptr<HandControl> hand_;
  std::string why_no_hand_;
  std::vector<std::string> robot_links_;
  std::shared_ptr<const Robot> robot_model_;  // null without
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
