#include "pliant/ros/interactive/interactive_markers.h"

#include <fmt/format.h>
#include <interactive_markers/interactive_marker_server.h>
#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/math/error.h"
#include "pliant/ros/conversions.h"

namespace pliant {
namespace {

// Of menus of bodies: the lines below "Attach here" follow those of the actions.
constexpr std::uint32_t kFirstHolder = 100, kResetLine = 99;
constexpr std::size_t kMostHolders = 20;
enum HandLine : std::uint32_t { kOpen = 1, kClose, kStop, kGiveBack, kResetAll };
constexpr double kStill = 1e-5;       // a hand that moved by less is shown where it was [m]
constexpr double kLineWidth = 0.004;  // [m]

Eigen::Isometry3d pose_in_message(const geometry_msgs::Pose& pose) {
  Eigen::Quaterniond turn(pose.orientation.w, pose.orientation.x, pose.orientation.y,
                          pose.orientation.z);
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = turn.normalized().toRotationMatrix();
  result.translation() = to_vector(pose.position);
  return result;
}

std::vector<std::string> holders_in(const World& world) {
  std::vector<std::string> names = {"world"};
  for (const Obstacle& obstacle : world.obstacles()) {
    const std::string& own = obstacle.link.empty() ? obstacle.name : obstacle.link;
    const bool is_new = std::find(names.begin(), names.end(), own) == names.end();
    if (is_new && !obstacle.liquid && names.size() < kMostHolders) names.push_back(own);
  }
  return names;
}

std::vector<MenuLine> hand_menu(const HandControl& control) {
  std::vector<MenuLine> menu;
  if (control.hand()->has_fingers()) {
    menu.push_back({kOpen, 0, "Open the gripper"});
    menu.push_back({kClose, 0, "Close the gripper"});
  }
  menu.push_back({kStop, 0, "Stop"});
  menu.push_back(
      {kGiveBack, 0, control.hand()->has_usual() ? "Back to the keyframes" : "Back to the start"});
  menu.push_back({kResetAll, 0, "Reset the scene"});
  return menu;
}

}  // namespace

InteractiveMarkers::InteractiveMarkers(ros::NodeHandle& node, const NodeParameters& parameters,
                                       SimulationThread& simulation, const Hands& hands)
    : node_(node),
      frame_(parameters.frame_id),
      topic_(node.resolveName("interactive")),
      period_(parameters.interactive_rate > 0.0 ? 1.0 / parameters.interactive_rate : 0.0),
      tool_{parameters.drag_radius, {parameters.drag_stiffness, parameters.drag_force_limit}},
      grip_force_(parameters.grip_force > 0.0 ? parameters.grip_force
                                              : std::numeric_limits<double>::infinity()),
      simulation_(simulation),
      why_no_hand_(hands.why_not) {
  for (const auto& control : hands.hands) hands_.push_back({control.get(), false, {}});
  if (period_ == 0.0) return;
  update_ = node_.advertise<visualization_msgs::InteractiveMarkerUpdate>(
      topic_ + "/update", 100,
      [this](const ros::SingleSubscriberPublisher&) { changed_.notify_one(); });
  thread_ = std::thread([this] { run(); });
}

InteractiveMarkers::~InteractiveMarkers() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void InteractiveMarkers::run() {
  auto next = std::chrono::steady_clock::now();
  const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(period_));
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stop_) {
    std::deque<Feedback> events;
    events.swap(events_);
    lock.unlock();
    const bool is_wanted = update_.getNumSubscribers() > 0;
    if (is_wanted && !server_) start();
    if (!is_wanted && server_) end();
    if (server_) {
      for (const Feedback& event : events) take(event);
      if (std::chrono::steady_clock::now() >= next) {
        refresh();
        next = std::chrono::steady_clock::now() + period;
      }
      server_->applyChanges();
    }
    lock.lock();
    if (!stop_ && events_.empty()) changed_.wait_for(lock, period);
  }
  lock.unlock();
  if (server_) end();
}

void InteractiveMarkers::start() {
  make_menus();
  server_ = std::make_unique<interactive_markers::InteractiveMarkerServer>(topic_, "", true);
  for (const std::string& why : why_no_hand_) ROS_INFO("%s", why.c_str());
  why_no_hand_.clear();
}

void InteractiveMarkers::end() {
  server_.reset();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (bodies_[b].grabbed) let_go(b);
  }
  bodies_.clear();
  for (HandMarker& hand : hands_) {
    hand.is_dragged = false;
    hand.shown.reset();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  events_.clear();
}

void InteractiveMarkers::make_menus() {
  const BodyNames& names = simulation_.names();
  bodies_.assign(names.size(), {});
  simulation_.ask([&](Simulation& simulation) {
    holders_ = holders_in(simulation.world());
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      bodies_[b].actions = actions_of(simulation.world(), b);
    }
    return Answer{true, "", 0.0};
  });
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    BodyMarker& body = bodies_[b];
    body.name = "body/" + names.graph_name(b);
    for (const BodyAction action : body.actions) {
      const auto id = static_cast<std::uint32_t>(body.menu.size()) + 1;
      body.menu.push_back({id, 0, title_of(action)});
    }
    body.menu.push_back({kResetLine, 0, "Reset the scene"});
    for (std::size_t h = 0; h < holders_.size(); ++h) {
      const auto id = kFirstHolder + static_cast<std::uint32_t>(h);
      body.menu.push_back({id, 1, "to " + holders_[h]});
    }
  }
}

void InteractiveMarkers::refresh() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) refresh_body(b);
  for (HandMarker& hand : hands_) refresh_hand(hand);
}

void InteractiveMarkers::refresh_body(std::size_t b) {
  BodyMarker& body = bodies_[b];
  const std::string line = body.name + "/spring";
  TriangleMesh surface;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  simulation_.ask([&](Simulation& simulation) {
    Body& own = simulation.world().bodies()[b];
    // rviz moves what is dragged by itself.
    if (!body.grabbed) surface = own.model->surface();
    if (body.grabbed && drag_of(own).is_holding()) center = drag_of(own).center();
    return Answer{true, "", 0.0};
  });
  if (body.grabbed) {
    Eigen::Matrix<double, 3, 2> ends;
    ends << center, body.target;
    if (body.line == ends) return;
    server_->insert(spring_line(line, frame_, center, body.target, kLineWidth));
    body.line = ends;
    return;
  }
  if (body.line) server_->erase(line);
  body.line.reset();
  const bool is_same = surface.vertices.size() == body.shown.vertices.size() &&
                       surface.vertices == body.shown.vertices;
  if (surface.triangles.cols() == 0 || is_same) return;
  server_->insert(surface_to_drag(body.name, frame_, surface, body.menu), on_feedback());
  body.shown = std::move(surface);
}

void InteractiveMarkers::refresh_hand(HandMarker& hand) {
  if (hand.is_dragged) return;
  const HandControl& control = *hand.control;
  const Eigen::Isometry3d pose = control.pose(simulation_);
  visualization_msgs::InteractiveMarker known;
  if (!server_->get(control.name(), known)) {
    const double size = std::clamp(0.15 * control.reach(), 0.06, 0.3);
    server_->insert(
        hand_to_drag(control.name(), frame_, pose, size, control.can_turn(), hand_menu(control)),
        on_feedback());
  } else if (!hand.shown || (pose.matrix() - hand.shown->matrix()).norm() > kStill) {
    put_back(control.name(), pose);
  } else {
    return;
  }
  hand.shown = pose;
}

InteractiveMarkers::Callback InteractiveMarkers::on_feedback() {
  return [this](const visualization_msgs::InteractiveMarkerFeedbackConstPtr& feedback) {
    const std::lock_guard<std::mutex> lock(mutex_);
    // Of a hand that moves faster than the simulation steps, the last place counts.
    const bool replaces = !events_.empty() && feedback->event_type == Feedback::POSE_UPDATE &&
                          events_.back().event_type == Feedback::POSE_UPDATE &&
                          events_.back().marker_name == feedback->marker_name;
    if (replaces) events_.pop_back();
    events_.push_back(*feedback);
    changed_.notify_one();
  };
}

Eigen::Isometry3d InteractiveMarkers::frame_of(const Feedback& feedback) {
  const std::string& frame = feedback.header.frame_id;
  if (frame.empty() || frame == frame_) return Eigen::Isometry3d::Identity();
  if (!frames_) frames_ = std::make_unique<FrameTransformer>(frame_);
  return frames_->from(frame);
}

Eigen::Isometry3d InteractiveMarkers::pose_of(const Feedback& feedback) {
  const Eigen::Isometry3d pose = pose_in_message(feedback.pose);
  if (!pose.matrix().allFinite()) {
    throw InputError("feedback for '" + feedback.marker_name + "': the pose is not finite");
  }
  return frame_of(feedback) * pose;
}

Eigen::Vector3d InteractiveMarkers::mouse_of(const Feedback& feedback) {
  const Eigen::Vector3d point = to_vector(feedback.mouse_point);
  if (!feedback.mouse_point_valid || !point.allFinite()) {
    throw InputError("feedback for '" + feedback.marker_name +
                     "' names no point of the surface: click on the body itself");
  }
  return frame_of(feedback) * point;
}

void InteractiveMarkers::put_back(const std::string& marker, const Eigen::Isometry3d& pose) {
  std_msgs::Header header;
  header.frame_id = frame_;
  server_->setPose(marker, to_pose(pose), header);
}

void InteractiveMarkers::tell(const Answer& answer) {
  if (answer.success) {
    ROS_INFO("%s", answer.message.c_str());
  } else {
    ROS_WARN("%s", answer.message.c_str());
  }
}

void InteractiveMarkers::take(const Feedback& feedback) {
  try {
    for (HandMarker& hand : hands_) {
      if (hand.control->name() == feedback.marker_name) take_for_hand(hand, feedback);
    }
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (bodies_[b].name == feedback.marker_name) take_for_body(b, feedback);
    }
  } catch (const InputError& error) {
    ROS_WARN("%s", error.what());
  }
}

void InteractiveMarkers::take_for_body(std::size_t b, const Feedback& feedback) {
  BodyMarker& body = bodies_[b];
  switch (feedback.event_type) {
    case Feedback::MOUSE_DOWN: {
      const Eigen::Vector3d point = mouse_of(feedback);
      const Answer answer = simulation_.ask([&](Simulation& simulation) {
        body.grabbed = body.target = grab(simulation, b, point, tool_);
        return Answer{true, "", simulation.world().time()};
      });
      if (!answer.success) throw InputError(answer.message);
      return;
    }
    case Feedback::POSE_UPDATE: {
      if (!body.grabbed) return;
      const Eigen::Vector3d target = *body.grabbed + pose_of(feedback).translation();
      simulation_.ask([&](Simulation& simulation) {
        drag_to(simulation, b, target);
        return Answer{true, "", simulation.world().time()};
      });
      body.target = target;
      return;
    }
    case Feedback::MOUSE_UP:
      let_go(b);
      return;
    case Feedback::MENU_SELECT:
      choose(b, feedback);
      return;
    default:
      return;
  }
}

void InteractiveMarkers::let_go(std::size_t b) {
  BodyMarker& body = bodies_[b];
  if (!body.grabbed) return;
  body.grabbed.reset();
  simulation_.ask([&](Simulation& simulation) {
    pliant::let_go(simulation, b);
    return Answer{true, "", simulation.world().time()};
  });
  // The surface is where the body is, not where the mouse took it.
  body.shown = {};
  if (server_) put_back(body.name, Eigen::Isometry3d::Identity());
}

void InteractiveMarkers::choose(std::size_t b, const Feedback& feedback) {
  const BodyMarker& body = bodies_[b];
  const std::uint32_t line = feedback.menu_entry_id;
  if (line == kResetLine) return tell(simulation_.reset());
  const bool is_holder = line >= kFirstHolder && line - kFirstHolder < holders_.size();
  if (!is_holder && (line == 0 || line > body.actions.size())) {
    throw InputError(fmt::format("the menu of '{}' has no line {}", body.name, line));
  }
  const BodyAction action = is_holder ? BodyAction::kAttach : body.actions[line - 1];
  const std::string to = is_holder ? holders_[line - kFirstHolder] : "world";
  const Eigen::Vector3d point =
      action == BodyAction::kRelease ? Eigen::Vector3d::Zero() : mouse_of(feedback);
  tell(simulation_.change(
      [&](Simulation& simulation) { return act(simulation, b, action, point, tool_, to); }));
}

void InteractiveMarkers::take_for_hand(HandMarker& marker, const Feedback& feedback) {
  if (feedback.event_type == Feedback::MOUSE_UP) marker.is_dragged = false;
  if (feedback.event_type == Feedback::MOUSE_DOWN) marker.is_dragged = true;
  if (feedback.event_type == Feedback::POSE_UPDATE) {
    marker.shown.reset();
    const Answer answer = marker.control->move_to(pose_of(feedback), simulation_);
    ROS_DEBUG("%s", answer.message.c_str());
  }
  if (feedback.event_type != Feedback::MENU_SELECT) return;
  if (feedback.menu_entry_id == kResetAll) return tell(simulation_.reset());
  tell(marker.control->command(simulation_, [&](RobotHand& hand) {
    switch (feedback.menu_entry_id) {
      case kOpen:
        hand.open();
        return std::string("the fingers open");
      case kClose:
        hand.close(grip_force_);
        return std::string("the fingers close");
      case kStop:
        hand.stop();
        return std::string("the robot stays where it is");
      case kGiveBack:
        hand.give_back();
        return std::string("the robot goes back to where it was taken");
      default:
        throw InputError(fmt::format("the hand's menu has no line {}", feedback.menu_entry_id));
    }
  }));
}

}  // namespace pliant
