#include "pliant/simulator.h"

#include <fmt/format.h>

#include <cmath>

#include "pliant/core/world.h"
#include "pliant/scene/scene.h"
#include "pliant/scene/wrenches.h"

namespace pliant {
namespace {

/// Joints stand where a program has put them.
class ProgramJoints final : public JointSource {
 public:
  explicit ProgramJoints(std::vector<double> initial) : values(std::move(initial)) {}
  void positions(double /*time*/, std::vector<double>& positions) override { positions = values; }

  std::vector<double> values;
};

SceneOverrides overrides_of(const SimulatorOptions& options) {
  SceneOverrides overrides;
  for (const auto& [path, text] : options.values) {
    overrides.values.push_back({path, text, {"SimulatorOptions::values", 1}});
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

}  // namespace

struct Simulator::Data {
  LoadedScene scene;
  std::vector<std::shared_ptr<ProgramJoints>> programs;  // of each robot; null: keyframes move it

  World& world() const { return *scene.world; }
  int index_of(const std::string& name) const {
    std::vector<std::string> names;
    for (const Body& body : world().bodies()) {
      if (body.name == name) return static_cast<int>(names.size());
      names.push_back(body.name);
    }
    throw InputError(unknown_name_message("body", name, names));
  }
  const Body& body(const std::string& name) const {
    return world().bodies()[static_cast<std::size_t>(index_of(name))];
  }
};

Simulator::Simulator(const std::string& scene_file, const SimulatorOptions& options)
    : data_(std::make_unique<Data>()) {
  data_->scene = load_scene(scene_file, overrides_of(options));
  for (const SceneRobot& robot : data_->scene.robots) {
    data_->programs.emplace_back();
    if (robot.driver != nullptr) continue;
    data_->programs.back() = std::make_shared<ProgramJoints>(robot.robot->initial_positions());
    data_->world().add_driver(std::make_unique<RobotDriver>(robot.robot, data_->programs.back()));
  }
}

Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;
Simulator::~Simulator() = default;

const std::vector<std::string>& Simulator::warnings() const { return data_->scene.warnings; }

double Simulator::time() const { return data_->world().time(); }
double Simulator::time_step() const { return data_->world().time_step(); }

void Simulator::step(int count) {
  if (count < 0) throw InputError(fmt::format("step: count is {}, but must be >= 0", count));
  if (count > 0 && !data_->world().advance(count)) throw StepError(data_->world().failure());
}

void Simulator::reset() { data_->world().reset(); }

std::vector<std::string> Simulator::bodies() const {
  std::vector<std::string> names;
  for (const Body& body : data_->world().bodies()) names.push_back(body.name);
  return names;
}

Eigen::Matrix3Xd Simulator::vertices(const std::string& body) const {
  return data_->body(body).model->surface().vertices;
}

Eigen::Matrix3Xi Simulator::triangles(const std::string& body) const {
  return data_->body(body).model->surface_triangles();
}

const Eigen::Matrix3Xd& Simulator::positions(const std::string& body) const {
  return data_->body(body).particles().x;
}

const Eigen::Matrix3Xd& Simulator::velocities(const std::string& body) const {
  return data_->body(body).particles().v;
}

Eigen::VectorXd Simulator::field(const std::string& body, const std::string& name) const {
  std::map<std::string, Eigen::VectorXd> fields = data_->body(body).model->point_fields();
  const auto found = fields.find(name);
  if (found != fields.end()) return std::move(found->second);
  std::vector<std::string> names;
  for (const auto& [known, values] : fields) names.push_back(known);
  throw InputError(unknown_name_message("field of body '" + body + "'", name, names));
}

Simulator::Report Simulator::report(const std::string& body) const {
  const StepReport& step = data_->body(body).report;
  return {std::string(step.solver),
          step.iterations,
          step.error,
          step.contacts,
          step.seconds,
          step.warnings,
          std::string(step.time_integration),
          std::string(step.first_order)};
}

void Simulator::apply_force(const std::string& body, const Eigen::Vector3d& point, double radius,
                            const Eigen::Vector3d& force, double duration) {
  data_->world().applied_forces().add(
      {point, radius, force, time(), duration, data_->index_of(body)});
}

void Simulator::clear_forces() { data_->world().applied_forces().clear(); }

std::vector<Simulator::Wrench> Simulator::wrenches() const {
  WrenchAverage step(data_->world().obstacles());
  step.add(data_->world().obstacles(), data_->world().reactions());
  std::vector<Wrench> wrenches;
  for (const pliant::Wrench& wrench : step.take()) {
    wrenches.push_back({wrench.name, wrench.is_robot_link, wrench.force, wrench.torque});
  }
  return wrenches;
}

std::vector<std::string> Simulator::joint_names() const {
  std::vector<std::string> names;
  for (const SceneRobot& robot : data_->scene.robots) {
    for (const std::string& joint : robot.robot->joint_names()) names.push_back(joint);
  }
  return names;
}

void Simulator::set_joint_positions(const std::map<std::string, double>& positions) {
  const std::vector<SceneRobot>& robots = data_->scene.robots;
  if (robots.empty()) throw InputError("set_joint_positions: the scene has no robot");
  std::vector<std::vector<double>> changed;
  for (const auto& program : data_->programs) {
    changed.push_back(program ? program->values : std::vector<double>());
  }
  for (const auto& [joint, position] : positions) {
    std::size_t r = 0;
    while (r < robots.size() && !robots[r].robot->joint_index(joint)) ++r;
    if (r == robots.size()) throw InputError(unknown_name_message("joint", joint, joint_names()));
    if (!data_->programs[r]) {
      throw InputError("set_joint_positions: keyframes of the scene move joint '" + joint +
                       "'; make the Simulator with robot_follows_keyframes = false");
    }
    const int index = *robots[r].robot->joint_index(joint);
    const Robot::Limits limits = robots[r].robot->limits(index);
    if (!(position >= limits.lower && position <= limits.upper) || !std::isfinite(position)) {
      throw InputError(fmt::format("joint '{}' is {}, but must be from {} to {}", joint, position,
                                   limits.lower, limits.upper));
    }
    changed[r][static_cast<std::size_t>(index)] = position;
  }
  for (std::size_t r = 0; r < robots.size(); ++r) {
    if (data_->programs[r]) data_->programs[r]->values = std::move(changed[r]);
  }
}

World& Simulator::world() { return data_->world(); }

}  // namespace pliant
