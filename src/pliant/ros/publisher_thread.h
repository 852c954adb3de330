#pragma once

#include <ros/node_handle.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "pliant/ros/mark_messages.h"
#include "pliant/ros/points_message.h"
#include "pliant/ros/surface_marker.h"

namespace pliant {

/// Publishers of a model node's topics.
struct NodePublishers {
  ros::Publisher surface, points, markers, wrenches, status, diagnostics;
};

/// Turns snapshots into messages and publishes them, so that neither conversion nor a slow
/// subscriber takes time of a step.
class PublisherThread {
 public:
  PublisherThread(const World& world, const std::string& frame, bool show_robot,
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

 private:
  void run();
  void publish();
  void publish_marks();

  Snapshot snapshot_;
  NodePublishers publishers_;
  VertexColors colors_;
  SurfaceMarker surface_;
  PointsMessage points_;
  MarkMessages marks_;
  std::atomic<bool> repeat_markers_{true};
  Timer since_everything_;

  std::mutex mutex_;
  std::condition_variable changed_;
  bool full_ = false;  // guarded by mutex_: the snapshot belongs to this thread
  bool stop_ = false;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace pliant
