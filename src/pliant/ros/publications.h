#pragma once

#include <ros/node_handle.h>

#include <memory>
#include <string>
#include <vector>

#include "pliant/ros/robot/scene_frames.h"
#include "pliant/ros/running/publisher_thread.h"
#include "pliant/ros/running/simulation.h"
#include "pliant/ros/running/step_statistics.h"
#include "pliant/scene/robot/wrenches.h"

namespace pliant {

/// Decides when which topic is due and copies out what it needs, in the simulation thread. Rates
/// are in wall time, since simulated time may stand still or fly. A topic without subscribers costs
/// nothing; one that the publisher thread is not ready for comes a step later.
class Publications {
 public:
  using Clock = std::chrono::steady_clock;

  /// Advertises the topics; `node` is private.
  Publications(ros::NodeHandle& node, const NodeParameters& parameters, bool show_robot,
               const Simulation& simulation);

  /// Takes the last step in.
  void add_step(const Simulation& simulation);
  /// Forgets the steps so far: the world was reset.
  void restart();
  /// Something happened that ~status and /diagnostics are to show at once.
  void hurry();
  /// Publishes what is due and can be seen (World::at_hand()).
  void publish_due(Simulation& simulation);
  /// What of the world has to be read back for what is published within the next `seconds`.
  Readback readback(const World& world, double seconds) const;
  /// Whether each step has to be taken alone, since of several at once nobody knows what touches.
  bool wants_single_steps() const;
  Clock::time_point next_due() const { return next_due_; }
  /// Resolved names of the topics, but for those of single bodies of several.
  const std::vector<std::string>& topics() const { return topics_; }

 private:
  /// Topics that are published together.
  struct Channel {
    unsigned content;
    std::size_t body;  // of a body's content
    std::vector<ros::Publisher> publishers;
    Clock::duration period;  // zero: off
    Clock::time_point next;
    bool is_due = false;
    bool has_subscribers() const;
  };

  void add_channels(const NodePublishers& publishers, const NodeParameters& parameters);
  void add_channel(unsigned content, std::vector<ros::Publisher> publishers, double rate,
                   std::size_t body = 0);
  /// Begins the means of a topic anew.
  void forget(unsigned content);
  /// Whether it can be seen now what a message shows.
  bool is_at_hand(const Channel& channel, const Simulation& simulation) const;
  /// Marks the channels that are due; returns whether some are.
  bool find_due(const Simulation& simulation, Clock::time_point now);
  /// What a message shows of the bodies.
  Readback shown_by(const Channel& channel, const World& world) const;
  void fill(Simulation& simulation, Snapshot& snapshot);
  void schedule(Clock::time_point now);
  void publish_clock(const Simulation& simulation);

  const BodyNames& names_;
  std::string frame_;
  std::string node_name_;
  std::vector<Channel> channels_;
  std::vector<std::string> topics_;
  Clock::time_point next_due_;
  ros::Publisher clock_;                                  // not valid unless /clock is published
  double last_clock_ = -1.0;                              // simulated time of the last /clock [s]
  std::vector<bool> is_wettable_, has_changing_surface_;  // of each body
  StepStatistics for_status_, for_diagnostics_;
  WrenchAverage wrenches_;
  SceneFrames frames_;
  bool shows_field_;  // instead of the bodies' own colours
  std::unique_ptr<PublisherThread> thread_;
};

}  // namespace pliant
