#include "pliant/ros/publisher_thread.h"

#include <diagnostic_msgs/DiagnosticArray.h>

namespace pliant {
namespace {

// A subscriber that lost a message gets obstacles that stand still again after so long [s].
constexpr double kRepeat = 2.0;

}  // namespace

PublisherThread::BodyMessages::BodyMessages(const Body& body)
    : colors(body, VertexColors::Of::kParticles), surface(body) {}

PublisherThread::PublisherThread(const World& world, const BodyNames& names,
                                 const std::string& frame, bool show_robot, const ColorBy& color_by,
                                 NodePublishers publishers)
    : snapshot_(world, fields_to_color(world.bodies(), color_by.quantity)),
      publishers_(std::move(publishers)),
      marks_(world, show_robot),
      shadows_(world),
      scale_(color_by.min, color_by.max),
      legend_(world.bodies(), color_by.quantity) {
  const bool is_alone = names.size() == 1;
  for (std::size_t b = 0; b < names.size(); ++b) {
    bodies_.emplace_back(world.bodies()[b]);
    // In rviz each body is switched on and off by its namespace.
    surfaces_.markers.push_back(
        bodies_[b].surface.first(frame, is_alone ? "surface" : names.graph_name(b)));
  }
  thread_ = std::thread([this] { run(); });
}

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
  if (publishers_.legend) color_bodies();
  publish_surfaces();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (snapshot_.bodies[b].contents & Snapshot::kPoints) publish_points(b);
  }
  if (contents & Snapshot::kShadows) publishers_.shadows.publish(shadows_.update(snapshot_));
  if (contents & Snapshot::kMarkers) publish_marks();
  if (contents & Snapshot::kWrenches) {
    snapshot_.wrenches.header = snapshot_.header;
    publishers_.wrenches.publish(snapshot_.wrenches);
  }
  publish_status();
}

void PublisherThread::color_bodies() {
  bool changed = !legend_is_sent_;
  for (BodySnapshot& body : snapshot_.bodies) {
    if (body.color_field.empty()) continue;
    const unsigned contents = body.contents | snapshot_.contents;
    if (contents & (Snapshot::kSurface | Snapshot::kSurfaces)) {
      changed = scale_.include(body.surface_values) || changed;
      body.surface_colors = scale_.colors(body.surface_values);
    }
    if (contents & Snapshot::kPoints) {
      changed = scale_.include(body.particle_values) || changed;
      body.particle_colors = scale_.colors(body.particle_values);
    }
  }
  if (!changed || !(scale_.min() < scale_.max())) return;
  publishers_.legend.publish(legend_.marker(snapshot_.header, scale_));
  legend_is_sent_ = true;
}

void PublisherThread::publish_surfaces() {
  const bool all = snapshot_.contents & Snapshot::kSurfaces;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const bool alone = snapshot_.bodies[b].contents & Snapshot::kSurface;
    if (!alone && !all) continue;
    bodies_[b].surface.update(snapshot_.bodies[b], snapshot_.header, surfaces_.markers[b]);
    if (!alone) continue;
    for (const ros::Publisher& topic : publishers_.bodies[b].surface) {
      topic.publish(surfaces_.markers[b]);
    }
  }
  if (all) publishers_.surfaces.publish(surfaces_);
}

void PublisherThread::publish_points(std::size_t body) {
  const BodySnapshot& snapshot = snapshot_.bodies[body];
  const auto wetness = snapshot.fields.find("wetness");
  const bool dry = wetness == snapshot.fields.end();
  const Eigen::Matrix3Xf& colors =
      snapshot.has_colors()
          ? snapshot.particle_colors
          : bodies_[body].colors.update(dry ? Eigen::VectorXd() : wetness->second);
  const sensor_msgs::PointCloud2& cloud =
      bodies_[body].points.update(snapshot, snapshot_.header, colors);
  for (const ros::Publisher& topic : publishers_.bodies[body].points) topic.publish(cloud);
}

void PublisherThread::publish_status() {
  if (snapshot_.contents & Snapshot::kStatus) {
    snapshot_.status.header = snapshot_.header;
    publishers_.status.publish(snapshot_.status);
  }
  if (snapshot_.contents & Snapshot::kDiagnostics) {
    diagnostic_msgs::DiagnosticArray array;
    array.header.stamp = snapshot_.header.stamp;
    array.status = snapshot_.diagnostics;
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
