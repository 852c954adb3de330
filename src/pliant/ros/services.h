#pragma once

#include <pliant/ApplyForce.h>
#include <pliant/Attach.h>
#include <pliant/ClearForces.h>
#include <pliant/Detach.h>
#include <pliant/ListSolvers.h>
#include <pliant/SetField.h>
#include <pliant/Step.h>
#include <pliant/SwitchSolver.h>
#include <ros/node_handle.h>
#include <std_srvs/Trigger.h>

#include <functional>
#include <string>
#include <vector>

#include "pliant/ros/robot/frame_transformer.h"
#include "pliant/ros/running/simulation_thread.h"

namespace pliant {

/// The services of a model node. Every callback may run in several threads at once, and answers
/// success and message; none relies on ROS time.
class Services {
 public:
  /// `node` is private; `frames` and `simulation` outlive this.
  Services(ros::NodeHandle& node, const FrameTransformer& frames, SimulationThread& simulation);

  /// Resolved names of the services.
  std::vector<std::string> names() const;

 private:
  void apply_force(ApplyForce::Request& request, ApplyForce::Response& response);
  void attach(Attach::Request& request, Attach::Response& response);
  void set_field(SetField::Request& request, SetField::Response& response);
  void switch_solver(SwitchSolver::Request& request, SwitchSolver::Response& response);
  void list_solvers(ListSolvers::Request& request, ListSolvers::Response& response);

  /// World from a frame when a request is carried out, since robot links move from step to step.
  using FrameAt = std::function<Eigen::Isometry3d(const Simulation&)>;
  /// Of a robot link, where the simulation has it, whether tf knows it or not; or of a tf frame.
  FrameAt find_frame(const std::string& frame);
  /// Of a request that names a point and a radius. Its center is in its frame yet.
  Region region_near(const std::string& service, const geometry_msgs::Point& point, double radius);

  SimulationThread& simulation_;
  const FrameTransformer& frames_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace pliant
