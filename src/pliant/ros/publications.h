#pragma once

#include <ros/node_handle.h>

#include <memory>
#include <string>
#include <vector>

#include "pliant/ros/publisher_thread.h"
#include "pliant/ros/simulation.h"
#include "pliant/ros/step_statistics.h"
#include "pliant/ros/wrench_average.h"

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
  /// What of the world is to be published within the next `seconds`.
  Wanted wanted(const World& world, double seconds) const;
  Clock::time_point next_due() const { return next_due_; }
  /// Resolved topic names.
  const std::vector<std::string>& topics() const { return topics_; }

 private:
  struct Channel {
    unsigned content;
    ros::Publisher publisher;
    Clock::duration period;  // zero: off
    Clock::time_point next;
  };

  void add_channel(unsigned content, const ros::Publisher& publisher, double rate);
  /// Begins the means of a topic anew.
  void forget(unsigned content);
  unsigned find_due(const World& world, Clock::time_point now);
  /// What a message shows of the bodies.
  Wanted shown_by(unsigned content, const World& world) const;
  void fill(Simulation& simulation, unsigned contents, Snapshot& snapshot);
  void schedule(unsigned contents, Clock::time_point now);
  void publish_clock(const Simulation& simulation);

  std::string frame_;
  std::string node_name_;
  std::vector<Channel> channels_;
  std::vector<std::string> topics_;
  Clock::time_point next_due_;
  ros::Publisher clock_;      // not valid unless /clock is published
  double last_clock_ = -1.0;  // simulated time of the last /clock [s]
  bool has_wetness_ = false;  // of some body
  StepStatistics for_status_, for_diagnostics_;
  WrenchAverage wrenches_;
  std::unique_ptr<PublisherThread> thread_;
};

}  // namespace pliant
