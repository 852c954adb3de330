#include "pliant/simulator.h"

#include <fmt/format.h>

#include "pliant/api/simulator_data.h"
#include "pliant/core/checkpoint_file.h"
#include "pliant/core/world.h"
#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/io/readable_file.h"

namespace pliant {

Simulator::Simulator(const std::string& scene_file, const SimulatorOptions& options)
    : data_(std::make_unique<Data>(load_scene(scene_file, overrides_of(options, nullptr)))) {}

Simulator::Simulator(std::unique_ptr<Data> data) : data_(std::move(data)) {}

Simulator Simulator::from_text(const std::string& text, const std::string& name,
                               const SimulatorOptions& options) {
  return Simulator(std::make_unique<Data>(load_scene(name, overrides_of(options, &text))));
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

double Simulator::State::time() const { return checkpoint_->time; }

void Simulator::State::write(const std::string& path) const {
  write_file_atomically(path, state_bytes({*checkpoint_, joints_}));
}

Simulator::State Simulator::State::read(const std::string& path) {
  SavedState saved = state_of(read_bytes(path), path);
  State state;
  state.checkpoint_ = std::make_shared<Checkpoint>(std::move(saved.checkpoint));
  state.joints_ = std::move(saved.joints);
  return state;
}

Simulator::State Simulator::save() const {
  State state;
  state.checkpoint_ = std::make_shared<Checkpoint>(data_->world().save());
  state.joints_ = data_->joints();
  return state;
}

void Simulator::load(const State& state) {
  data_->world().load(*state.checkpoint_);
  data_->set_joints(state.joints_);
}

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

std::vector<std::string> Simulator::joint_names() const { return data_->joint_names(); }

void Simulator::set_joint_positions(const std::map<std::string, double>& positions) {
  if (data_->scene.robots.empty()) {
    throw InputError("set_joint_positions: the scene has no robot");
  }
  std::vector<std::vector<double>> joints = data_->joints();
  for (const auto& [joint, position] : positions) data_->change(joint, position, joints);
  data_->set_joints(std::move(joints));
}

std::vector<double> Simulator::joint_positions() const {
  std::vector<double> all;
  for (const SceneRobot& robot : data_->scene.robots) {
    const std::vector<double>& own = robot.driver->positions();
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

Simulator::JointLimits Simulator::joint_limits(const std::string& joint) const {
  const Robot& robot = *data_->scene.robots[data_->robot_of(joint)].robot;
  const Robot::Limits limits = robot.limits(*robot.joint_index(joint));
  return {limits.lower, limits.upper};
}

Eigen::Isometry3d Simulator::link_pose(const std::string& link) const {
  std::vector<std::string> names;
  for (const SceneRobot& robot : data_->scene.robots) {
    if (robot.robot->link_index(link)) return robot.link_pose(link);
    for (const std::string& known : robot.robot->link_names()) names.push_back(known);
  }
  throw InputError(unknown_name_message("link", link, names));
}

World& Simulator::world() { return data_->world(); }

}  // namespace pliant
