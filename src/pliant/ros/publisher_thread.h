#pragma once

#include <ros/node_handle.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "pliant/ros/body_names.h"
#include "pliant/ros/color_by.h"
#include "pliant/ros/mark_messages.h"
#include "pliant/ros/points_message.h"
#include "pliant/ros/shadow_marker.h"
#include "pliant/ros/surface_marker.h"

namespace pliant {

/// Publishers of a body's topics: the first of several bodies has each of them twice.
struct BodyPublishers {
  std::vector<ros::Publisher> surface, points;
};

/// Publishers of a model node's topics.
struct NodePublishers {
  std::vector<BodyPublishers> bodies;
  ros::Publisher surfaces;  // not valid with one body
  ros::Publisher shadows, markers, wrenches, status, diagnostics;
  ros::Publisher legend;  // not valid without ~color_by
};

/// Turns snapshots into messages and publishes them, so that neither conversion nor a slow
/// subscriber takes time of a step.
class PublisherThread {
 public:
  PublisherThread(const World& world, const BodyNames& names, const std::string& frame,
                  bool show_robot, const ColorBy& color_by, NodePublishers publishers);
  ~PublisherThread();
  PublisherThread(const PublisherThread&) = delete;
  PublisherThread& operator=(const PublisherThread&) = delete;

  /// The snapshot to fill, or null while the last one is being published. Never waits long.
  Snapshot* begin();
  /// Publishes what begin() gave.
  void commit();
  /// The next ~markers message brings everything; from any thread.
  void repeat_markers() { repeat_markers_ = true; }

 private:
  void run();
  void publish();
  /// Turns the values that colours show into colours, and tells their range where it changed.
  void color_bodies();
  void publish_surfaces();
  void publish_points(std::size_t body);
  void publish_marks();
  void publish_status();

  struct BodyMessages {
    explicit BodyMessages(const Body& body);
    VertexColors colors;
    SurfaceMarker surface;
    PointsMessage points;
  };

  Snapshot snapshot_;
  NodePublishers publishers_;
  std::vector<BodyMessages> bodies_;
  visualization_msgs::MarkerArray surfaces_;  // of all bodies, in order
  MarkMessages marks_;
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
