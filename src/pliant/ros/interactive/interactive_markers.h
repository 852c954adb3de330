#pragma once

#include <ros/node_handle.h>
#include <visualization_msgs/InteractiveMarkerFeedback.h>

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "pliant/ros/interactive/hand_control.h"
#include "pliant/ros/interactive/interactive_commands.h"
#include "pliant/ros/interactive/interactive_messages.h"
#include "pliant/ros/robot/frame_transformer.h"

namespace interactive_markers {
class InteractiveMarkerServer;
}

namespace pliant {

/// What the mouse can take hold of in rviz: the surface of each body, dragged by a spring, with a
/// menu; and the hand of each robot. While nobody subscribes to `~interactive/update` there is no
/// server and no marker, and nothing is asked of the simulation.
class InteractiveMarkers {
 public:
  /// Why robots have no hand is logged once, when somebody looks. `simulation` and `hands` outlive
  /// this.
  InteractiveMarkers(ros::NodeHandle& node, const NodeParameters& parameters,
                     SimulationThread& simulation, const Hands& hands);
  ~InteractiveMarkers();
  InteractiveMarkers(const InteractiveMarkers&) = delete;
  InteractiveMarkers& operator=(const InteractiveMarkers&) = delete;

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;
  using Callback =
      boost::function<void(const visualization_msgs::InteractiveMarkerFeedbackConstPtr&)>;
  struct BodyMarker {
    std::string name;
    std::vector<MenuLine> menu;
    std::vector<BodyAction> actions;  // of menu line id - 1
    TriangleMesh shown;
    std::optional<Eigen::Vector3d> grabbed;  // where the mass centre was when it was grabbed [m]
    Eigen::Vector3d target = Eigen::Vector3d::Zero();
    std::optional<Eigen::Matrix<double, 3, 2>> line;  // the spring's, as it is shown [m]
  };

  struct HandMarker {
    HandControl* control;
    bool is_dragged = false;
    std::optional<Eigen::Isometry3d> shown;  // none: the mouse moved the marker elsewhere
  };

  void run();
  void start();
  void end();
  void make_menus();
  void refresh();
  void refresh_body(std::size_t body);
  void refresh_hand(HandMarker& hand);
  Callback on_feedback();
  void take(const Feedback& feedback);
  void take_for_body(std::size_t body, const Feedback& feedback);
  void take_for_hand(HandMarker& hand, const Feedback& feedback);
  void choose(std::size_t body, const Feedback& feedback);
  void let_go(std::size_t body);
  /// In the node's frame.
  Eigen::Isometry3d pose_of(const Feedback& feedback);
  Eigen::Vector3d mouse_of(const Feedback& feedback);
  Eigen::Isometry3d frame_of(const Feedback& feedback);
  void put_back(const std::string& marker, const Eigen::Isometry3d& pose);
  static void tell(const Answer& answer);

  ros::NodeHandle node_;
  std::string frame_;
  std::string topic_;
  double period_;  // wall time [s]
  MouseTool tool_;
  double grip_force_;  // [N]
  SimulationThread& simulation_;
  std::vector<HandMarker> hands_;
  std::vector<std::string> why_no_hand_;  // not said yet
  ros::Publisher update_;                 // counts subscribers; the server has its own
  std::unique_ptr<interactive_markers::InteractiveMarkerServer> server_;
  std::unique_ptr<FrameTransformer> frames_;  // once somebody needs it
  std::vector<BodyMarker> bodies_;
  std::vector<std::string> holders_;  // what bodies can be attached to

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Feedback> events_;  // guarded by mutex_
  bool stop_ = false;            // guarded by mutex_
  std::thread thread_;
};

}  // namespace pliant
