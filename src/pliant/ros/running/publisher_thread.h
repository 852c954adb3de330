#pragma once

#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "pliant/ros/body_names.h"
#include "pliant/ros/markers/color_by.h"
#include "pliant/ros/markers/contact_messages.h"
#include "pliant/ros/markers/mark_messages.h"
#include "pliant/ros/markers/mesh_messages.h"
#include "pliant/ros/markers/points_message.h"
#include "pliant/ros/markers/shadow_marker.h"
#include "pliant/ros/markers/surface_marker.h"
#include "pliant/ros/node_publishers.h"
#include "pliant/ros/robot/scene_frames.h"

namespace pliant {

/// Turns snapshots into messages and publishes them, so that neither conversion nor a slow
/// subscriber takes time of a step.
class PublisherThread {
 public:
  /// `header`: of what is said once, at the beginning: triangles, and `frames` of what stands.
  PublisherThread(const World& world, const BodyNames& names, const std_msgs::Header& header,
                  const SceneFrames& frames, bool show_robot, const ColorBy& color_by,
                  NodePublishers publishers);
  ~PublisherThread();
  PublisherThread(const PublisherThread&) = delete;
  PublisherThread& operator=(const PublisherThread&) = delete;

  /// The snapshot to fill, or null while the last one is being published. Never waits long.
  Snapshot* begin();
  /// Publishes what begin() gave.
  void commit();
  /// The next ~markers message brings everything; from any thread.
  void repeat_markers() { repeat_markers_ = true; }
  /// Sends a new subscriber to /tf what was last said there; from any thread.
  void repeat_frames(const ros::SingleSubscriberPublisher& subscriber);

 private:
  void run();
  void publish();
  /// Turns the values that colours show into colours, and tells their range where it changed.
  bool follow_values();
  void color_bodies();
  void publish_surfaces();
  void publish_points(std::size_t body);
  void publish_mesh(std::size_t body);
  void publish_contacts();
  void publish_wrenches();
  void publish_frames();
  void publish_standing(const SceneFrames& frames, const std_msgs::Header& header);
  void publish_marks();
  void publish_status();

  struct BodyMessages {
    BodyMessages(const Body& body, const std::string& name);
    VertexColors colors;
    SurfaceMarker surface;
    PointsMessage points;
    MeshMessages mesh;
  };

  Snapshot snapshot_;
  NodePublishers publishers_;
  std::vector<BodyMessages> bodies_;
  visualization_msgs::MarkerArray surfaces_;  // of all bodies, in order
  MarkMessages marks_;
  ContactMessages contacts_;
  std::vector<std::string> wrench_frames_;  // of each wrench
  tf2_ros::StaticTransformBroadcaster standing_;
  std::mutex frames_mutex_;
  tf2_msgs::TFMessage frames_;  // guarded by frames_mutex_
  Timer since_frames_;          // was published; likewise
  ShadowMarker shadows_;
  ColorScale scale_;
  ColorLegend legend_;
  bool legend_is_sent_ = false;
  std::atomic<bool> repeat_markers_{true};
  Timer since_everything_;

  std::mutex mutex_;
  std::condition_variable changed_;
  bool full_ = false;  // guarded by mutex_: the snapshot belongs to this thread
  bool stop_ = false;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace pliant
