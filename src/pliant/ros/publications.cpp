#include "pliant/ros/publications.h"

#include <rosgraph_msgs/Clock.h>

#include <algorithm>

#include "pliant/ros/node_publishers.h"
#include "pliant/ros/status_messages.h"

namespace pliant {
namespace {

constexpr double kDiagnosticsRate = 1.0;  // [Hz], as diagnostic aggregators expect
constexpr double kClockPeriod = 0.01;     // simulated [s]

}  // namespace

Publications::Publications(ros::NodeHandle& node, const NodeParameters& parameters, bool show_robot,
                           const Simulation& simulation)
    : names_(simulation.names()),
      frame_(parameters.frame_id),
      node_name_(node.getNamespace()),
      next_due_(Clock::now()),
      for_status_(names_.size()),
      for_diagnostics_(names_.size()),
      wrenches_(simulation.world().obstacles()),
      frames_(simulation, node_name_,
              parameters.publish_robot_tf.value_or(simulation.drives_robot())),
      shows_field_(parameters.color_by.quantity != "none") {
  for (const Body& body : simulation.world().bodies()) {
    is_wettable_.push_back(can_be_wet(body));
    has_changing_surface_.push_back(body.model->surface_changes());
  }
  const auto on_markers = [this](const ros::SingleSubscriberPublisher&) {
    if (thread_) thread_->repeat_markers();
  };
  const auto on_frames = [this](const ros::SingleSubscriberPublisher& subscriber) {
    if (thread_) thread_->repeat_frames(subscriber);
  };
  const NodePublishers publishers =
      advertise_topics(node, names_, wrenches_.means(), shows_field_, on_markers, on_frames);
  if (publishers.legend) topics_.push_back(publishers.legend.getTopic());
  add_channels(publishers, parameters);
  if (parameters.publish_clock) {
    clock_ = node.advertise<rosgraph_msgs::Clock>("/clock", 10, true);
    topics_.push_back(clock_.getTopic());
  }
  std_msgs::Header header;
  header.stamp = simulation.now();
  header.frame_id = frame_;
  thread_ = std::make_unique<PublisherThread>(simulation.world(), names_, header, frames_,
                                              show_robot, parameters.color_by, publishers);
  thread_->repeat_markers();
}

void Publications::add_channels(const NodePublishers& publishers,
                                const NodeParameters& parameters) {
  for (std::size_t b = 0; b < names_.size(); ++b) {
    const BodyPublishers& body = publishers.bodies[b];
    add_channel(Snapshot::kSurface, body.surface, parameters.surface_rate, b);
    add_channel(Snapshot::kPoints, body.points, parameters.points_rate, b);
    std::vector<ros::Publisher> mesh = body.mesh_points;
    // Where triangles change, who wants these alone gets them too.
    if (has_changing_surface_[b])
      mesh.insert(mesh.end(), body.mesh_topology.begin(), body.mesh_topology.end());
    add_channel(Snapshot::kMesh, mesh, parameters.mesh_rate, b);
  }
  if (publishers.surfaces) {
    add_channel(Snapshot::kSurfaces, {publishers.surfaces}, parameters.surface_rate);
  }
  add_channel(Snapshot::kShadows, {publishers.shadows}, parameters.surface_rate);
  add_channel(Snapshot::kMarkers, {publishers.markers}, parameters.markers_rate);
  add_channel(Snapshot::kContacts, {publishers.contacts}, parameters.contacts_rate);
  std::vector<ros::Publisher> wrenches = {publishers.wrenches};
  wrenches.insert(wrenches.end(), publishers.each_wrench.begin(), publishers.each_wrench.end());
  add_channel(Snapshot::kWrenches, wrenches, parameters.wrenches_rate);
  add_channel(Snapshot::kStatus, {publishers.status}, parameters.status_rate);
  add_channel(Snapshot::kDiagnostics, {publishers.diagnostics}, kDiagnosticsRate);
  add_channel(Snapshot::kFrames, {publishers.frames}, parameters.tf_rate);
}

void Publications::add_channel(unsigned content, std::vector<ros::Publisher> publishers,
                               double rate, std::size_t body) {
  using std::chrono::duration;
  const Clock::duration period =
      rate > 0.0 ? std::chrono::duration_cast<Clock::duration>(duration<double>(1.0 / rate))
                 : Clock::duration::zero();
  if (body == 0) topics_.push_back(publishers.front().getTopic());
  channels_.push_back({content, body, std::move(publishers), period, Clock::now()});
}

bool Publications::Channel::has_subscribers() const {
  return std::any_of(publishers.begin(), publishers.end(), [](const ros::Publisher& publisher) {
    return publisher.getNumSubscribers() > 0;
  });
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

Readback Publications::shown_by(const Channel& channel, const World& world) const {
  const auto is_held = [](const Body& body) { return body.find_effect("attachment") != nullptr; };
  const auto of_surface = [this](bool is_wettable) {
    return is_wettable || shows_field_ ? Readback::kMotion : Readback::kSurface;
  };
  switch (channel.content) {
    case Snapshot::kMesh:
      return Readback::kSurface;
    case Snapshot::kSurface:
      return of_surface(is_wettable_[channel.body]);
    case Snapshot::kSurfaces:
    case Snapshot::kShadows:
      return of_surface(std::count(is_wettable_.begin(), is_wettable_.end(), true) > 0);
    case Snapshot::kMarkers:
      return std::any_of(world.bodies().begin(), world.bodies().end(), is_held)
                 ? Readback::kMotion
                 : Readback::kNothing;
    case Snapshot::kWrenches:
    case Snapshot::kDiagnostics:
    case Snapshot::kFrames:
      return Readback::kNothing;
    default:
      return Readback::kMotion;
  }
}

Readback Publications::readback(const World& world, double seconds) const {
  using std::chrono::duration;
  const Clock::time_point until =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(duration<double>(seconds));
  Readback readback = Readback::kNothing;
  for (const Channel& channel : channels_) {
    const bool is_off = channel.period == Clock::duration::zero() || until < channel.next;
    if (is_off || !channel.has_subscribers()) continue;
    readback = std::max(readback, shown_by(channel, world));
  }
  return readback;
}

bool Publications::wants_single_steps() const {
  return std::any_of(channels_.begin(), channels_.end(), [](const Channel& channel) {
    return channel.content == Snapshot::kContacts && channel.period > Clock::duration::zero() &&
           channel.has_subscribers();
  });
}

bool Publications::is_at_hand(const Channel& channel, const Simulation& simulation) const {
  const World& world = simulation.world();
  if (channel.content == Snapshot::kContacts && !simulation.knows_contacts()) return false;
  return shown_by(channel, world) <= world.at_hand();
}

bool Publications::find_due(const Simulation& simulation, Clock::time_point now) {
  bool some = false;
  for (Channel& channel : channels_) {
    channel.is_due = false;
    if (channel.period == Clock::duration::zero() || now < channel.next) continue;
    if (channel.has_subscribers()) {
      // What cannot be seen now is due at the next observation.
      channel.is_due = is_at_hand(channel, simulation);
      some = some || channel.is_due;
    } else {
      forget(channel.content);
      channel.next = now + channel.period;
    }
  }
  return some;
}

void Publications::schedule(Clock::time_point now) {
  for (Channel& channel : channels_) {
    if (!channel.is_due) continue;
    // Keeps the rate on average, but makes up for no more than one message.
    channel.next = std::max(channel.next + channel.period, now);
  }
}

void Publications::publish_due(Simulation& simulation) {
  if (clock_) publish_clock(simulation);
  const Clock::time_point now = Clock::now();
  if (now < next_due_) return;
  if (find_due(simulation, now)) {
    Snapshot* snapshot = thread_->begin();
    if (snapshot == nullptr) {
      next_due_ = now + std::chrono::milliseconds(1);
      return;
    }
    fill(simulation, *snapshot);
    thread_->commit();
    schedule(now);
  }
  next_due_ = Clock::time_point::max();
  for (const Channel& channel : channels_) {
    if (channel.period > Clock::duration::zero()) next_due_ = std::min(next_due_, channel.next);
  }
}

void Publications::fill(Simulation& simulation, Snapshot& snapshot) {
  snapshot.clear_contents();
  for (const Channel& channel : channels_) {
    if (!channel.is_due) continue;
    const bool is_of_body =
        channel.content & (Snapshot::kSurface | Snapshot::kPoints | Snapshot::kMesh);
    (is_of_body ? snapshot.bodies[channel.body].contents : snapshot.contents) |= channel.content;
  }
  const unsigned contents = snapshot.contents;
  snapshot.header.stamp = simulation.now();
  snapshot.header.frame_id = frame_;
  snapshot.take(simulation.world());
  if (contents & Snapshot::kWrenches) snapshot.wrenches = wrenches_.take();
  if (contents & Snapshot::kFrames) frames_.list_moving(simulation, snapshot.frames);
  if (contents & Snapshot::kStatus) fill_status(simulation, for_status_, snapshot.status);
  if (contents & Snapshot::kDiagnostics) {
    fill_diagnostics(simulation, for_diagnostics_, node_name_, snapshot.diagnostics);
  }
  for (const unsigned content : {Snapshot::kStatus, Snapshot::kDiagnostics}) {
    if (contents & content) forget(content);
  }
}

}  // namespace pliant
