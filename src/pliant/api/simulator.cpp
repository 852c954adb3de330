#include "pliant/simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/core/world.h"
#include "pliant/scene/scene.h"

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
  overrides.time_step = options.time_step;
  overrides.threads = options.threads;
  if (!options.urdf.empty()) overrides.robot_description = options.urdf;
  overrides.drive_robot_from_keyframes = options.robot_follows_keyframes;
  return overrides;
}

/// The frame of its link, or the obstacle's own: world from it.
Eigen::Isometry3d frame_of(const Obstacle& obstacle) {
  return obstacle.pose_end * obstacle.link_from_shape.inverse();
}

}  // namespace

struct Simulator::Data {
  LoadedScene scene;
  std::shared_ptr<ProgramJoints> program;  // null: keyframes move the robot, or there is none

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
  const LoadedScene& scene = data_->scene;
  if (!scene.robot) return;
  if (options.robot_follows_keyframes && !scene.spec.robot->keyframes_path.empty()) return;
  data_->program = std::make_shared<ProgramJoints>(scene.robot->initial_positions());
  scene.world->add_driver(std::make_unique<RobotDriver>(scene.robot, data_->program));
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
          step.warnings};
}

void Simulator::apply_force(const std::string& body, const Eigen::Vector3d& point, double radius,
                            const Eigen::Vector3d& force, double duration) {
  data_->world().applied_forces().add(
      {point, radius, force, time(), duration, data_->index_of(body)});
}

void Simulator::clear_forces() { data_->world().applied_forces().clear(); }

std::vector<Simulator::Wrench> Simulator::wrenches() const {
  const std::vector<Obstacle>& obstacles = data_->world().obstacles();
  const std::vector<Reaction>& reactions = data_->world().reactions();
  std::vector<Wrench> wrenches;
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    const bool is_link = !obstacles[o].link.empty();
    const std::string& name = is_link ? obstacles[o].link : obstacles[o].name;
    const auto same = [&](const Wrench& wrench) {
      return is_link && wrench.is_link && wrench.name == name;
    };
    auto found = std::find_if(wrenches.begin(), wrenches.end(), same);
    if (found == wrenches.end()) found = wrenches.insert(found, Wrench{name, is_link});
    if (o >= reactions.size()) continue;
    const Eigen::Vector3d arm =
        obstacles[o].pose_end.translation() - frame_of(obstacles[o]).translation();
    found->force += reactions[o].force;
    found->torque += reactions[o].torque + arm.cross(reactions[o].force);
  }
  std::stable_partition(wrenches.begin(), wrenches.end(),
                        [](const Wrench& wrench) { return wrench.is_link; });
  return wrenches;
}

std::vector<std::string> Simulator::joint_names() const {
  return data_->scene.robot ? data_->scene.robot->joint_names() : std::vector<std::string>();
}

void Simulator::set_joint_positions(const std::map<std::string, double>& positions) {
  const LoadedScene& scene = data_->scene;
  if (!scene.robot) throw InputError("set_joint_positions: the scene has no robot");
  if (!data_->program) {
    throw InputError(
        "set_joint_positions: keyframes of the scene move the robot; make the Simulator with "
        "robot_follows_keyframes = false");
  }
  std::vector<double> changed = data_->program->values;
  for (const auto& [joint, position] : positions) {
    const std::optional<int> index = scene.robot->joint_index(joint);
    if (!index) throw InputError(unknown_name_message("joint", joint, joint_names()));
    const Robot::Limits limits = scene.robot->limits(*index);
    if (!(position >= limits.lower && position <= limits.upper) || !std::isfinite(position)) {
      throw InputError(fmt::format("joint '{}' is {}, but must be from {} to {}", joint, position,
                                   limits.lower, limits.upper));
    }
    changed[static_cast<std::size_t>(*index)] = position;
  }
  data_->program->values = std::move(changed);
}

World& Simulator::world() { return data_->world(); }

}  // namespace pliant
