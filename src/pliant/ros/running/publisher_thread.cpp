#include "pliant/ros/running/publisher_thread.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/WrenchStamped.h>
#include <pliant/LinkWrenches.h>

#include <algorithm>
#include <utility>

#include "pliant/ros/conversions.h"

namespace pliant {
namespace {

// A subscriber that lost a message gets obstacles that stand still again after so long [s].
constexpr double kRepeat = 2.0;
// Of /tf, after which a new subscriber is sent what was said last [s].
constexpr double kFramesPause = 0.3;

geometry_msgs::TransformStamped stamped(const PlacedFrame& frame, const std_msgs::Header& header) {
  geometry_msgs::TransformStamped transform;
  transform.header = header;
  transform.child_frame_id = frame.name;
  transform.transform = to_transform(frame.pose);
  return transform;
}

}  // namespace

PublisherThread::BodyMessages::BodyMessages(const Body& body, const std::string& name)
    : colors(body, VertexColors::Of::kParticles), surface(body), mesh(body, name) {}

PublisherThread::PublisherThread(const World& world, const BodyNames& names,
                                 const std_msgs::Header& header, const SceneFrames& frames,
                                 bool show_robot, const ColorBy& color_by,
                                 NodePublishers publishers)
    : snapshot_(world, fields_to_color(world.bodies(), color_by.quantity)),
      publishers_(std::move(publishers)),
      marks_(world, show_robot),
      contacts_(world, names),
      shadows_(world),
      scale_(color_by.min, color_by.max, color_by.tail),
      legend_(world.bodies(), color_by.quantity) {
  const bool is_alone = names.size() == 1;
  for (std::size_t b = 0; b < names.size(); ++b) {
    bodies_.emplace_back(world.bodies()[b], names.name(b));
    // In rviz each body is switched on and off by its namespace.
    surfaces_.markers.push_back(
        bodies_[b].surface.first(header.frame_id, is_alone ? "surface" : names.graph_name(b)));
    bodies_[b].mesh.set_header(header);
    for (const ros::Publisher& topic : publishers_.bodies[b].mesh_topology) {
      topic.publish(bodies_[b].mesh.topology());
    }
  }
  for (const Wrench& wrench : zero_wrenches(world.obstacles())) {
    wrench_frames_.push_back(frames.frame_of(wrench));
  }
  publish_standing(frames, header);
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
    if (snapshot_.bodies[b].contents & Snapshot::kMesh) publish_mesh(b);
  }
  if (contents & Snapshot::kShadows) publishers_.shadows.publish(shadows_.update(snapshot_));
  if (contents & Snapshot::kMarkers) publish_marks();
  if (contents & Snapshot::kContacts) publish_contacts();
  if (contents & Snapshot::kWrenches) publish_wrenches();
  if (contents & Snapshot::kFrames) publish_frames();
  publish_status();
}

/// The range of the colours follows what all bodies have.
bool PublisherThread::follow_values() {
  std::vector<double> values;
  for (const BodySnapshot& body : snapshot_.bodies) {
    if (body.color_field.empty()) continue;
    const unsigned contents = body.contents | snapshot_.contents;
    const bool on_surface = contents & (Snapshot::kSurface | Snapshot::kSurfaces);
    if (!on_surface && !(contents & Snapshot::kPoints)) continue;
    const Eigen::VectorXd& own = on_surface ? body.surface_values : body.particle_values;
    values.insert(values.end(), own.data(), own.data() + own.size());
  }
  return scale_.follow(std::move(values), snapshot_.time);
}

void PublisherThread::color_bodies() {
  const bool changed = follow_values() || !legend_is_sent_;
  for (BodySnapshot& body : snapshot_.bodies) {
    if (body.color_field.empty()) continue;
    const unsigned contents = body.contents | snapshot_.contents;
    if (contents & (Snapshot::kSurface | Snapshot::kSurfaces)) {
      body.surface_colors = scale_.colors(body.surface_values);
    }
    if (contents & Snapshot::kPoints) {
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

void PublisherThread::publish_mesh(std::size_t body) {
  MeshMessages& mesh = bodies_[body].mesh;
  const BodyPublishers& publishers = publishers_.bodies[body];
  // Before the points that are numbered by them.
  if (mesh.update(snapshot_.bodies[body], snapshot_.header)) {
    for (const ros::Publisher& topic : publishers.mesh_topology) topic.publish(mesh.topology());
  }
  for (const ros::Publisher& topic : publishers.mesh_points) topic.publish(mesh.points());
}

void PublisherThread::publish_contacts() {
  contacts_.message().header = snapshot_.header;
  publishers_.contacts.publish(contacts_.update(snapshot_.touched, snapshot_.step));
}

void PublisherThread::publish_wrenches() {
  LinkWrenches all;
  all.header = snapshot_.header;
  for (std::size_t w = 0; w < snapshot_.wrenches.size(); ++w) {
    const Wrench& wrench = snapshot_.wrenches[w];
    LinkWrench link;
    link.name = wrench.name;
    link.is_robot_link = wrench.is_robot_link;
    link.wrench.force = to_vector3(wrench.force);
    link.wrench.torque = to_vector3(wrench.torque);
    geometry_msgs::WrenchStamped stamped;
    stamped.header.stamp = snapshot_.header.stamp;
    stamped.header.frame_id = wrench_frames_[w];
    stamped.wrench = link.wrench;
    publishers_.each_wrench[w].publish(stamped);
    all.links.push_back(link);
  }
  publishers_.wrenches.publish(all);
}

void PublisherThread::publish_standing(const SceneFrames& frames, const std_msgs::Header& header) {
  std::vector<geometry_msgs::TransformStamped> transforms;
  for (const PlacedFrame& frame : frames.standing()) transforms.push_back(stamped(frame, header));
  if (!transforms.empty()) standing_.sendTransform(transforms);
}

void PublisherThread::publish_frames() {
  const std::lock_guard<std::mutex> lock(frames_mutex_);
  const tf2_msgs::TFMessage last = std::exchange(frames_, {});
  // tf complains of what it hears twice for one time, as while the simulation is paused.
  const auto is_said = [&](const geometry_msgs::TransformStamped& now) {
    return std::any_of(last.transforms.begin(), last.transforms.end(), [&](const auto& said) {
      return said.child_frame_id == now.child_frame_id && said.header.stamp == now.header.stamp;
    });
  };
  tf2_msgs::TFMessage news;
  for (const PlacedFrame& frame : snapshot_.frames) {
    // Many a robot's root link is called "world".
    if (frame.name == snapshot_.header.frame_id) continue;
    frames_.transforms.push_back(stamped(frame, snapshot_.header));
    if (!is_said(frames_.transforms.back())) news.transforms.push_back(frames_.transforms.back());
  }
  if (news.transforms.empty()) return;
  publishers_.frames.publish(news);
  since_frames_ = Timer();
}

void PublisherThread::repeat_frames(const ros::SingleSubscriberPublisher& subscriber) {
  const std::lock_guard<std::mutex> lock(frames_mutex_);
  // While time goes on the next message comes soon, and tf complains of what it hears twice.
  if (!frames_.transforms.empty() && since_frames_.seconds() > kFramesPause) {
    subscriber.publish(frames_);
  }
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
