#include "pliant/ros/publications.h"

#include <rosgraph_msgs/Clock.h>

#include <algorithm>

#include "pliant/ros/status_messages.h"

namespace pliant {
namespace {

constexpr double kDiagnosticsRate = 1.0;  // [Hz], as diagnostic aggregators expect
constexpr double kClockPeriod = 0.01;     // simulated [s]

}  // namespace

Publications::Publications(ros::NodeHandle& node, const NodeParameters& parameters, bool show_robot,
                           const Simulation& simulation)
    : frame_(parameters.frame_id),
      node_name_(node.getNamespace()),
      next_due_(Clock::now()),
      wrenches_(simulation.world().obstacles()) {
  NodePublishers publishers;
  publishers.surface = node.advertise<visualization_msgs::Marker>("surface", 1);
  publishers.points = node.advertise<sensor_msgs::PointCloud2>("points", 1);
  publishers.markers = node.advertise<visualization_msgs::MarkerArray>(
      "markers", 10, [this](const ros::SingleSubscriberPublisher&) {
        if (thread_) thread_->repeat_markers();
      });
  publishers.wrenches = node.advertise<LinkWrenches>("contact_wrenches", 10);
  publishers.status = node.advertise<SolverStatus>("status", 10);
  publishers.diagnostics = node.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 10);
  add_channel(Snapshot::kSurface, publishers.surface, parameters.surface_rate);
  add_channel(Snapshot::kPoints, publishers.points, parameters.points_rate);
  add_channel(Snapshot::kMarkers, publishers.markers, parameters.markers_rate);
  add_channel(Snapshot::kWrenches, publishers.wrenches, parameters.wrenches_rate);
  add_channel(Snapshot::kStatus, publishers.status, parameters.status_rate);
  add_channel(Snapshot::kDiagnostics, publishers.diagnostics, kDiagnosticsRate);
  if (parameters.publish_clock) {
    clock_ = node.advertise<rosgraph_msgs::Clock>("/clock", 10, true);
    topics_.push_back(clock_.getTopic());
  }
  for (const Body& body : simulation.world().bodies()) {
    has_wetness_ = has_wetness_ || body.model->point_fields().count("wetness") > 0;
  }
  thread_ = std::make_unique<PublisherThread>(simulation.world(), frame_, show_robot, publishers);
  thread_->repeat_markers();
}

void Publications::add_channel(unsigned content, const ros::Publisher& publisher, double rate) {
  using std::chrono::duration;
  const Clock::duration period =
      rate > 0.0 ? std::chrono::duration_cast<Clock::duration>(duration<double>(1.0 / rate))
                 : Clock::duration::zero();
  channels_.push_back({content, publisher, period, Clock::now()});
  topics_.push_back(publisher.getTopic());
}

void Publications::add_step(const Simulation& simulation) {
  const World& world = simulation.world();
  const double seconds = simulation.last_step_seconds();
  for_status_.add(world.bodies(), world.time_step(), seconds);
  for_diagnostics_.add(world.bodies(), world.time_step(), seconds);
  wrenches_.add(world.obstacles(), world.reactions());
}

void Publications::restart() {
  for_status_.clear();
  for_diagnostics_.clear();
  wrenches_.clear();
  last_clock_ = -1.0;
}

void Publications::hurry() {
  for (Channel& channel : channels_) {
    if (channel.content & (Snapshot::kStatus | Snapshot::kDiagnostics)) channel.next = Clock::now();
  }
  next_due_ = Clock::now();
}

void Publications::publish_clock(const Simulation& simulation) {
  const double time = simulation.world().time();
  if (last_clock_ >= 0.0 && time < last_clock_ + kClockPeriod) return;
  last_clock_ = time;
  rosgraph_msgs::Clock message;
  message.clock = ros::Time(time);
  clock_.publish(message);
}

void Publications::forget(unsigned content) {
  if (content == Snapshot::kWrenches) wrenches_.take();
  if (content == Snapshot::kStatus) for_status_.clear();
  if (content == Snapshot::kDiagnostics) for_diagnostics_.clear();
}

Wanted Publications::shown_by(unsigned content, const World& world) const {
  const auto is_held = [](const Body& body) { return body.find_effect("attachment") != nullptr; };
  switch (content) {
    case Snapshot::kSurface:
      return has_wetness_ ? Wanted::kMotion : Wanted::kSurface;
    case Snapshot::kMarkers:
      return std::any_of(world.bodies().begin(), world.bodies().end(), is_held) ? Wanted::kMotion
                                                                                : Wanted::kNothing;
    case Snapshot::kWrenches:
    case Snapshot::kDiagnostics:
      return Wanted::kNothing;
    default:
      return Wanted::kMotion;
  }
}

Wanted Publications::wanted(const World& world, double seconds) const {
  using std::chrono::duration;
  const Clock::time_point until =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(duration<double>(seconds));
  Wanted wanted = Wanted::kNothing;
  for (const Channel& channel : channels_) {
    const bool is_off = channel.period == Clock::duration::zero() || until < channel.next;
    if (is_off || channel.publisher.getNumSubscribers() == 0) continue;
    wanted = std::max(wanted, shown_by(channel.content, world));
  }
  return wanted;
}

unsigned Publications::find_due(const World& world, Clock::time_point now) {
  unsigned contents = 0;
  for (Channel& channel : channels_) {
    if (channel.period == Clock::duration::zero() || now < channel.next) continue;
    if (channel.publisher.getNumSubscribers() > 0) {
      // What cannot be seen now is due at the next look.
      if (shown_by(channel.content, world) <= world.at_hand()) contents |= channel.content;
    } else {
      forget(channel.content);
      channel.next = now + channel.period;
    }
  }
  return contents;
}

void Publications::schedule(unsigned contents, Clock::time_point now) {
  for (Channel& channel : channels_) {
    if (!(channel.content & contents)) continue;
    // Keeps the rate on average, but makes up for no more than one message.
    channel.next = std::max(channel.next + channel.period, now);
  }
}

void Publications::publish_due(Simulation& simulation) {
  if (clock_) publish_clock(simulation);
  const Clock::time_point now = Clock::now();
  if (now < next_due_) return;
  if (const unsigned contents = find_due(simulation.world(), now)) {
    Snapshot* snapshot = thread_->begin();
    if (snapshot == nullptr) {
      next_due_ = now + std::chrono::milliseconds(1);
      return;
    }
    fill(simulation, contents, *snapshot);
    thread_->commit();
    schedule(contents, now);
  }
  next_due_ = Clock::time_point::max();
  for (const Channel& channel : channels_) {
    if (channel.period > Clock::duration::zero()) next_due_ = std::min(next_due_, channel.next);
  }
}

void Publications::fill(Simulation& simulation, unsigned contents, Snapshot& snapshot) {
  snapshot.contents = contents;
  snapshot.header.stamp = simulation.now();
  snapshot.header.frame_id = frame_;
  snapshot.take(simulation.world(), has_wetness_);
  if (contents & Snapshot::kWrenches) snapshot.wrenches.links = wrenches_.take();
  if (contents & Snapshot::kStatus) fill_status(simulation, for_status_, snapshot.status);
  if (contents & Snapshot::kDiagnostics) {
    fill_diagnostics(simulation, for_diagnostics_, node_name_, snapshot.diagnostics);
  }
  for (const unsigned content : {Snapshot::kStatus, Snapshot::kDiagnostics}) {
    if (contents & content) forget(content);
  }
}

}  // namespace pliant
