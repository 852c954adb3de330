#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "pliant/math/error.h"

namespace pliant {

struct Checkpoint;
class World;

/// A step whose result was not finite: it was undone. The message names body, vertex and time, and
/// says what to try.
class StepError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a program asks for instead of what the scene says.
struct SimulatorOptions {
  /// Values by their path in the scene file, as YAML in one line:
  /// {"bodies[towel].material.areal_density", "0.2"}. Keys that are not there yet are added.
  std::map<std::string, std::string> values;
  std::string solver;                                    ///< another one; "" the scene's
  std::map<std::string, std::string> solver_parameters;  ///< by name
  std::string time_integration;                          ///< another one; "" the scene's
  std::optional<double> time_step;                       ///< [s]
  std::optional<int> threads;                            ///< of a step; results do not depend on it
  std::string urdf;                     ///< the robot's text; "" the file that the scene names
  bool robot_follows_keyframes = true;  ///< false: set_joint_positions() alone moves the robot
};

/// Soft bodies, obstacles and a robot, as a scene file describes them, that a program steps.
///
/// Units are SI, positions are in the world's frame. Bodies are called as the scene calls them; an
/// unknown name, as any other bad input, is an InputError, which says what is allowed, and nothing
/// has changed. Not thread-safe: one thread at a time uses a simulator; others may use others.
class Simulator {
 public:
  /// Throws InputError "FILE:LINE: ..." for what is wrong with the scene or the options.
  explicit Simulator(const std::string& scene_file, const SimulatorOptions& options = {});
  /// Of a scene file's text, which need not be in a file: messages call it `name`, and its relative
  /// paths begin in the folder of that.
  static Simulator from_text(const std::string& text, const std::string& name,
                             const SimulatorOptions& options = {});
  /// One that was moved from can only be destroyed or assigned to.
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;  ///< likewise
  ~Simulator();

  /// What is legal in the scene but surely not meant.
  const std::vector<std::string>& warnings() const;

  // ---- time -------------------------------------------------------------------------------------

  double time() const;       ///< simulated [s]
  double time_step() const;  ///< [s]
  /// Takes `count` steps. Throws StepError where one is not finite: those before it are kept.
  void step(int count = 1);
  /// Back to the start, bit for bit; applied forces are forgotten, joints stay.
  void reset();

  /// All that a scene needs to go on bit for bit from where it was saved. Cheap to copy.
  class State {
   public:
    double time() const;  ///< [s]
    /// To a file, in place of what is there, which this version of Pliant on this kind of machine
    /// reads. Throws InputError: it cannot be written, or forces act (clear_forces()) or fields are
    /// on their way to a value, which no file holds.
    void write(const std::string& path) const;
    /// Throws InputError for a file that is damaged or no state.
    static State read(const std::string& path);

   private:
    friend class Simulator;
    std::shared_ptr<const Checkpoint> checkpoint_;
    std::vector<std::vector<double>> joints_;  // of each robot that set_joint_positions() moves
  };
  State save() const;  ///< where the simulation is now
  /// Goes back to what this simulator, or another one of the same scene, saved. Throws InputError,
  /// and then nothing changed, for a state of another scene. wrenches() are 0 until the next step.
  void load(const State& state);

  // ---- bodies -----------------------------------------------------------------------------------

  std::vector<std::string> bodies() const;  ///< their names, in the scene's order
  /// The vertices of the surface that is drawn, as they now are, 3 x n [m].
  Eigen::Matrix3Xd vertices(const std::string& body) const;
  /// The surface's triangles, 3 x m indices of vertices().
  Eigen::Matrix3Xi triangles(const std::string& body) const;
  /// Where the body's particles are, 3 x n [m]. Of cloth they are the vertices.
  const Eigen::Matrix3Xd& positions(const std::string& body) const;
  /// How fast they are, 3 x n [m/s].
  const Eigen::Matrix3Xd& velocities(const std::string& body) const;
  /// A number of each particle that the model knows, as "temperature" or "stretch".
  Eigen::VectorXd field(const std::string& body, const std::string& name) const;

  /// How a step went for a body.
  struct Report {
    std::string solver;  ///< by which the step was taken
    int iterations = 0;  ///< that it took
    /// Estimated distance of the body from where converged steps would have taken it, as a share of
    /// the path that it came; empty: nothing estimates it.
    std::optional<double> error;
    int contacts = 0;                   ///< that carry force
    double seconds = 0.0;               ///< that the step took
    std::vector<std::string> warnings;  ///< empty in a normal step
    std::string time_integration;       ///< "": the solver has one of its own
    /// Why the step was one of implicit Euler where `time_integration` is another; "": it was not.
    std::string first_order;
  };
  /// Of the last step.
  Report report(const std::string& body) const;

  // ---- forces -----------------------------------------------------------------------------------

  /// Lets `force` [N] act for `duration` [s] (below 0: until clear_forces(); 0: one step) on the
  /// vertices of `body` that are now within `radius` [m] of `point` [m]; radius 0: on the nearest.
  void apply_force(const std::string& body, const Eigen::Vector3d& point, double radius,
                   const Eigen::Vector3d& force, double duration);
  void clear_forces();  ///< ends all forces of apply_force()

  /// Holds the vertices of `body` that are now within `radius` of `point` [m] to an obstacle, a
  /// robot link or "world", from where they are, by springs of `stiffness` together [N/m]; until
  /// detach() or reset(). Returns how many; throws InputError where there is none.
  int attach(const std::string& body, const std::string& name, const Eigen::Vector3d& point,
             double radius, const std::string& holder, double stiffness);
  /// Lets go of what attach(), or an attachment of the scene, holds by that name. Throws InputError
  /// where there is none.
  void detach(const std::string& body, const std::string& name);
  /// The names of what holds a body, or will: those of the scene too.
  std::vector<std::string> attachments(const std::string& body) const;

  /// A place where a body is touched, at the end of the last step.
  struct Contact {
    std::string body;   ///< that is touched
    int vertex = 0;     ///< particle of the body that carries most of the point
    std::string other;  ///< the obstacle, robot link or body that touches it
    Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< [m]
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< of length 1, away from the other
    Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< on the body, friction too [N]
  };
  /// Those that carry force, body by body. A place between two bodies is listed once.
  std::vector<Contact> contacts() const;

  /// What bodies did to a robot link or an obstacle during the last step, about the origin and in
  /// the axes of its own frame.
  struct Wrench {
    std::string name;                                  ///< of the link or the obstacle
    bool is_link = false;                              ///< of the robot
    Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
  };
  /// Of all obstacles and all links that have a collision shape, links first.
  std::vector<Wrench> wrenches() const;

  // ---- robot ------------------------------------------------------------------------------------

  /// Movable joints of all robots but for those that mimic others; none without a robot.
  std::vector<std::string> joint_names() const;
  /// Where they shall be at the end of the next step [m] or [rad]; those that are not named stay.
  /// Links move there evenly during the step, however far it is. Throws InputError also where
  /// keyframes move the robot (robot_follows_keyframes).
  void set_joint_positions(const std::map<std::string, double>& positions);
  /// Where they are at the end of the last step [m] or [rad], in the order of joint_names().
  std::vector<double> joint_positions() const;
  /// Between what a joint may be [m] or [rad]; infinite for a continuous joint.
  struct JointLimits {
    double lower = 0.0;  ///< the least
    double upper = 0.0;  ///< the most
  };
  /// Those that the robot's URDF gives. Throws InputError for a joint that there is not.
  JointLimits joint_limits(const std::string& joint) const;
  /// World from a robot's link, at the end of the last step.
  Eigen::Isometry3d link_pose(const std::string& link) const;

  // ---- for more than this -----------------------------------------------------------------------

  /// All that Pliant has of it (pliant/core/world.h), which changes from version to version.
  World& world();

 private:
  friend class SimulatorBatch;
  struct Data;
  explicit Simulator(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

}  // namespace pliant
