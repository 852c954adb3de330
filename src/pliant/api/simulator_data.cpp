#include "pliant/api/simulator_data.h"

#include <fmt/format.h>

#include <cmath>

#include "pliant/core/world.h"

namespace pliant {

SceneOverrides overrides_of(const SimulatorOptions& options, const std::string* text) {
  SceneOverrides overrides;
  if (text != nullptr) overrides.text = *text;
  for (const auto& [path, value] : options.values) {
    overrides.values.push_back({path, value, {"SimulatorOptions::values", 1}});
  }
  if (!options.solver.empty()) overrides.solver = options.solver;
  overrides.solver_parameters = {options.solver_parameters.begin(),
                                 options.solver_parameters.end()};
  if (!options.time_integration.empty()) overrides.time_integration = options.time_integration;
  overrides.time_step = options.time_step;
  overrides.threads = options.threads;
  if (!options.urdf.empty()) overrides.robot_description = options.urdf;
  overrides.drive_robot_from_keyframes = options.robot_follows_keyframes;
  return overrides;
}

Simulator::Data::Data(LoadedScene loaded) : scene(std::move(loaded)) {
  for (SceneRobot& robot : scene.robots) {
    programs.emplace_back();
    if (robot.driver != nullptr) continue;
    programs.back() = std::make_shared<ProgramJoints>(robot.robot->initial_positions());
    auto driver = std::make_unique<RobotDriver>(robot.robot, programs.back());
    robot.driver = driver.get();
    world().add_driver(std::move(driver));
  }
}

int Simulator::Data::index_of(const std::string& body) const {
  std::vector<std::string> names;
  for (const Body& known : world().bodies()) {
    if (known.name == body) return static_cast<int>(names.size());
    names.push_back(known.name);
  }
  throw InputError(unknown_name_message("body", body, names));
}

const Body& Simulator::Data::body(const std::string& name) const {
  return world().bodies()[static_cast<std::size_t>(index_of(name))];
}

std::vector<std::vector<double>> Simulator::Data::joints() const {
  std::vector<std::vector<double>> joints;
  for (const auto& program : programs) {
    joints.push_back(program ? program->values : std::vector<double>());
  }
  return joints;
}

void Simulator::Data::set_joints(std::vector<std::vector<double>> joints) {
  for (std::size_t r = 0; r < programs.size(); ++r) {
    if (programs[r]) programs[r]->values = std::move(joints[r]);
  }
}

std::vector<std::string> Simulator::Data::joint_names() const {
  std::vector<std::string> names;
  for (const SceneRobot& robot : scene.robots) {
    for (const std::string& joint : robot.robot->joint_names()) names.push_back(joint);
  }
  return names;
}

std::size_t Simulator::Data::robot_of(const std::string& joint) const {
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    if (scene.robots[r].robot->joint_index(joint)) return r;
  }
  throw InputError(unknown_name_message("joint", joint, joint_names()));
}

void Simulator::Data::change(const std::string& joint, double position,
                             std::vector<std::vector<double>>& joints) const {
  const std::size_t r = robot_of(joint);
  if (!programs[r]) {
    throw InputError("set_joint_positions: keyframes of the scene move joint '" + joint +
                     "'; make the Simulator with robot_follows_keyframes = false");
  }
  const Robot& robot = *scene.robots[r].robot;
  const int index = *robot.joint_index(joint);
  const Robot::Limits limits = robot.limits(index);
  if (!(position >= limits.lower && position <= limits.upper) || !std::isfinite(position)) {
    throw InputError(fmt::format("joint '{}' is {}, but must be from {} to {}", joint, position,
                                 limits.lower, limits.upper));
  }
  joints[r][static_cast<std::size_t>(index)] = position;
}

}  // namespace pliant
