#pragma once

#include <functional>
#include <thread>

#include "pliant/ros/publications.h"
#include "pliant/ros/running/command_queue.h"
#include "pliant/ros/running/simulation.h"

namespace pliant {

/// Runs a simulation in a thread of its own, the only one that touches its world. What other
/// threads ask for is done between two steps; they wait for the answer.
class SimulationThread {
 public:
  /// `simulation` and `publications` outlive this and belong to its thread until stop().
  SimulationThread(Simulation& simulation, Publications& publications);
  /// Stops.
  ~SimulationThread();
  SimulationThread(const SimulationThread&) = delete;
  SimulationThread& operator=(const SimulationThread&) = delete;

  // Requests, from any thread but its own.
  Answer pause();
  Answer resume();
  Answer reset();
  Answer step(int steps);
  /// Has `request` done; what it throws becomes the answer.
  using Request = std::function<Answer(Simulation&)>;
  Answer ask(const Request& request);
  /// As ask(); ~status and /diagnostics show at once what it changed.
  Answer change(const Request& request);
  /// Of the scene; from any thread.
  const BodyNames& names() const { return simulation_.names(); }
  /// Of all robots; from any thread.
  const std::vector<std::string>& link_names() const { return simulation_.link_names(); }

  /// Ends the thread; requests that wait or come later are answered with that.
  void stop();

 private:
  void run();
  void make_step();

  Simulation& simulation_;
  Publications& publications_;
  CommandQueue queue_;
  std::thread thread_;
};

}  // namespace pliant
