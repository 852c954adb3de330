#include "pliant/ros/publisher_thread.h"

namespace pliant {
namespace {

// A subscriber that lost a message gets obstacles that stand still again after so long [s].
constexpr double kRepeat = 2.0;

}  // namespace

PublisherThread::PublisherThread(const World& world, const std::string& frame, bool show_robot,
                                 NodePublishers publishers)
    : publishers_(std::move(publishers)),
      colors_(world, VertexColors::Of::kParticles),
      surface_(world, frame),
      marks_(world, show_robot),
      thread_([this] { run(); }) {}

PublisherThread::~PublisherThread() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

Snapshot* PublisherThread::begin() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return full_ ? nullptr : &snapshot_;
}

void PublisherThread::commit() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    full_ = true;
  }
  changed_.notify_one();
}

void PublisherThread::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return full_ || stop_; });
    if (stop_) return;
    lock.unlock();
    publish();
    lock.lock();
    full_ = false;
  }
}

void PublisherThread::publish() {
  const unsigned contents = snapshot_.contents;
  if (contents & Snapshot::kSurface) publishers_.surface.publish(surface_.update(snapshot_));
  if (contents & Snapshot::kPoints) {
    const auto wetness = snapshot_.fields.find("wetness");
    const bool dry = wetness == snapshot_.fields.end();
    const Eigen::Matrix3Xf& colors =
        snapshot_.surface_changes ? snapshot_.particle_colors
                                  : colors_.update(dry ? Eigen::VectorXd() : wetness->second);
    publishers_.points.publish(points_.update(snapshot_, colors));
  }
  if (contents & Snapshot::kMarkers) {
    publish_marks();
  }
  if (contents & Snapshot::kWrenches) {
    snapshot_.wrenches.header = snapshot_.header;
    publishers_.wrenches.publish(snapshot_.wrenches);
  }
  if (contents & Snapshot::kStatus) {
    snapshot_.status.header = snapshot_.header;
    publishers_.status.publish(snapshot_.status);
  }
  if (contents & Snapshot::kDiagnostics) {
    diagnostic_msgs::DiagnosticArray array;
    array.header.stamp = snapshot_.header.stamp;
    array.status.push_back(snapshot_.diagnostics);
    publishers_.diagnostics.publish(array);
  }
}

void PublisherThread::publish_marks() {
  const bool everything = repeat_markers_.exchange(false) || since_everything_.seconds() > kRepeat;
  if (everything) since_everything_ = Timer();
  const visualization_msgs::MarkerArray& marks = marks_.update(snapshot_, everything);
  if (!marks.markers.empty()) publishers_.markers.publish(marks);
}

}  // namespace pliant
