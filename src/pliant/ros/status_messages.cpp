#include "pliant/ros/status_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {
namespace {

void fill_scene(const World& world, SolverStatus& status) {
  const BodyStatus& first = status.bodies.front();
  status.model = first.model;
  status.solver = first.solver;
  status.backend = first.backend;
  status.effects = first.effects;
  status.step = world.steps();
  status.sim_time = world.time();
  status.time_step = world.time_step();
  status.vertices = 0;
  status.total_mass = 0.0;
  for (const BodyStatus& body : status.bodies) {
    status.vertices += body.vertices;
    status.total_mass += body.mass;
  }
}

void fill_last_step(const World& world, SolverStatus& status) {
  status.iterations = status.contacts = 0;
  status.residual = 0.0;
  status.error = status.impulse_imbalance = -1.0;
  status.energy_gained = std::numeric_limits<double>::quiet_NaN();
  for (const BodyStatus& body : status.bodies) {
    status.iterations = std::max(status.iterations, body.iterations);
    status.contacts += body.contacts;
    status.residual = std::max(status.residual, body.residual);
    status.error = std::max(status.error, body.error);
    status.impulse_imbalance = std::max(status.impulse_imbalance, body.impulse_imbalance);
  }
  for (const Body& body : world.bodies()) {
    if (!body.report.energy_gained) continue;
    const bool is_first = std::isnan(status.energy_gained);
    status.energy_gained = *body.report.energy_gained + (is_first ? 0.0 : status.energy_gained);
  }
  const StepReport& first = world.bodies().front().report;
  status.ended_by = status.bodies.front().ended_by;
  status.figures.clear();
  status.figure_values.clear();
  for (const Figure& figure : first.figures) {
    status.figures.emplace_back(figure.name);
    status.figure_values.push_back(figure.value);
  }
  const Energies energies = world.energies();
  status.kinetic_energy = energies.kinetic;
  status.elastic_energy = energies.elastic;
  status.potential_energy = energies.potential;
}

void fill_cost(const StepStatistics& statistics, SolverStatus& status) {
  status.step_time = statistics.mean_time();
  status.step_time_max = statistics.max_time();
  status.real_time_factor = statistics.real_time_factor();
  status.phases.clear();
  status.phase_times.clear();
  for (const PhaseTime& phase : statistics.phases()) {
    status.phases.emplace_back(phase.name);
    status.phase_times.push_back(phase.seconds / static_cast<double>(statistics.steps()));
  }
}

void add_value(const std::string& key, const std::string& value,
               diagnostic_msgs::DiagnosticStatus& status) {
  diagnostic_msgs::KeyValue entry;
  entry.key = key;
  entry.value = value;
  status.values.push_back(entry);
}

diagnostic_msgs::DiagnosticStatus make_diagnostics(const Simulation& simulation,
                                                   const std::string& name,
                                                   const std::string& failure,
                                                   const std::vector<std::string>& warnings) {
  diagnostic_msgs::DiagnosticStatus status;
  status.name = name;
  status.hardware_id = "none";
  if (!failure.empty()) {
    status.level = diagnostic_msgs::DiagnosticStatus::ERROR;
    status.message = failure;
  } else if (!warnings.empty()) {
    status.level = diagnostic_msgs::DiagnosticStatus::WARN;
    status.message = fmt::format("{}", fmt::join(warnings, "; "));
  } else {
    status.level = diagnostic_msgs::DiagnosticStatus::OK;
    status.message = simulation.paused() ? "paused" : "running";
  }
  return status;
}

std::string backend_text(const StepReport& report) {
  const std::string why =
      report.backend_reason.empty() ? "" : " (auto: " + report.backend_reason + ")";
  return std::string(report.backend) + why;
}

diagnostic_msgs::DiagnosticStatus diagnostics_of_body(const Simulation& simulation,
                                                      const StepStatistics& statistics,
                                                      std::size_t index, const std::string& node) {
  const Body& body = simulation.world().bodies()[index];
  const StepReport& report = body.report;
  // Reports of a step that was undone tell of it until the next one.
  const std::string failure = simulation.failure().empty() ? "" : report.failure;
  diagnostic_msgs::DiagnosticStatus status = make_diagnostics(
      simulation, node + ": body " + body.name, failure, statistics.warnings(index));
  add_value("model", std::string(body.model->name()), status);
  add_value("solver", std::string(body.solver->name()), status);
  add_value("backend", backend_text(report), status);
  add_value("iterations", std::to_string(report.iterations), status);
  add_value("error", report.error ? fmt::format("{:.3g}", *report.error) : "not estimated", status);
  add_value("contacts", std::to_string(report.contacts), status);
  return status;
}

/// What stands, and what the steps said.
std::vector<std::string> all_warnings(const Simulation& simulation,
                                      const StepStatistics& statistics) {
  std::vector<std::string> warnings = simulation.notes();
  for (std::string& warning : statistics.warnings()) warnings.push_back(std::move(warning));
  return warnings;
}

/// Whose report tells the time of those that are moved together.
std::size_t first_of_group(const std::deque<Body>& bodies, std::size_t body) {
  for (std::size_t b = 0; b < body; ++b) {
    if (&bodies[b] == &bodies[body].group->first()) return b;
  }
  return body;
}

void fill_body(const Simulation& simulation, const StepStatistics& statistics, std::size_t index,
               BodyStatus& status) {
  const std::deque<Body>& bodies = simulation.world().bodies();
  const Body& body = bodies[index];
  const StepReport& report = body.report;
  status.name = body.name;
  status.topics = bodies.size() > 1 ? simulation.names().graph_name(index) : "";
  status.model = std::string(body.model->name());
  status.solver = std::string(body.solver->name());
  status.backend = std::string(report.backend);
  status.backend_reason = report.backend_reason;
  status.effects.clear();
  for (const auto& effect : body.effects) status.effects.emplace_back(effect->name());
  status.moved_with.clear();
  for (const Body* other : body.group->bodies()) {
    if (other != &body) status.moved_with.push_back(other->name);
  }
  status.vertices = static_cast<std::uint32_t>(body.particles().size());
  status.mass = body.particles().mass.sum();
  status.iterations = static_cast<std::uint32_t>(report.iterations);
  status.residual = report.residual;
  status.error = report.error.value_or(-1.0);
  status.impulse_imbalance = report.impulse_imbalance.value_or(-1.0);
  status.contacts = static_cast<std::uint32_t>(report.contacts);
  status.ended_by = std::string(to_string(report.ended_by));
  status.step_time = statistics.mean_time(first_of_group(bodies, index));
  status.warnings = statistics.warnings(index);
}

}  // namespace

void fill_status(const Simulation& simulation, const StepStatistics& statistics,
                 SolverStatus& status) {
  status.bodies.resize(simulation.world().bodies().size());
  for (std::size_t b = 0; b < status.bodies.size(); ++b) {
    fill_body(simulation, statistics, b, status.bodies[b]);
  }
  fill_scene(simulation.world(), status);
  fill_last_step(simulation.world(), status);
  fill_cost(statistics, status);
  status.warnings = all_warnings(simulation, statistics);
  if (!simulation.failure().empty()) status.warnings.push_back(simulation.failure());
  status.paused = simulation.paused();
}

void fill_diagnostics(const Simulation& simulation, const StepStatistics& statistics,
                      const std::string& node,
                      std::vector<diagnostic_msgs::DiagnosticStatus>& statuses) {
  const std::string name = node.substr(node.find_first_not_of('/'));
  statuses.assign(1, make_diagnostics(simulation, name + ": simulation", simulation.failure(),
                                      all_warnings(simulation, statistics)));
  diagnostic_msgs::DiagnosticStatus& status = statuses.front();
  const World& world = simulation.world();
  add_value("solver", simulation.solvers(), status);
  for (const Body& body : world.bodies()) {
    add_value("backend of " + body.name, backend_text(body.report), status);
  }
  add_value("simulated time [s]", fmt::format("{:.6g}", world.time()), status);
  add_value("time step [s]", fmt::format("{:g}", world.time_step()), status);
  add_value("step time, mean [s]", fmt::format("{:.3g}", statistics.mean_time()), status);
  add_value("step time, max [s]", fmt::format("{:.3g}", statistics.max_time()), status);
  add_value("real-time factor", fmt::format("{:.3g}", statistics.real_time_factor()), status);
  add_value("paused", simulation.paused() ? "true" : "false", status);
  for (std::size_t b = 0; world.bodies().size() > 1 && b < world.bodies().size(); ++b) {
    statuses.push_back(diagnostics_of_body(simulation, statistics, b, name));
  }
}

}  // namespace pliant
