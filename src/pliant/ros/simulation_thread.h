#pragma once

#include <string>
#include <thread>

#include "pliant/core/applied_force.h"
#include "pliant/ros/command_queue.h"
#include "pliant/ros/publications.h"
#include "pliant/ros/simulation.h"

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
  /// `force.start` is ignored: it starts at ROS time `start`; zero or in the past: now.
  Answer apply_force(const AppliedForce& force, const ros::Time& start);
  Answer clear_forces();
  /// Of the body of that name, or of all where it is empty.
  Answer switch_solver(const std::string& name, const ParameterText& parameters,
                       const std::string& body);
  Answer attach(const std::string& name, const Region& region, const std::string& to,
                double stiffness);
  Answer detach(const std::string& name);
  Answer set_field(const FieldRequest& request);
  /// The message is the solver's name.
  Answer current_solver();

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
