#include "pliant/ros/status_messages.h"

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/step/body_integration.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;

void fill_scene(const World& world, SolverStatus& status) {
  const BodyStatus& first = status.bodies.front();
  status.model = first.model;
  status.solver = first.solver;
  status.time_integration = first.time_integration;
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
  status.metrics.clear();
  status.metric_values.clear();
  for (const Metric& metric : first.metrics) {
    status.metrics.emplace_back(metric.name);
    status.metric_values.push_back(metric.value);
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

/// What it says where nothing is wrong: `fine`.
DiagnosticStatusWrapper make_diagnostics(const std::string& name, const std::string& failure,
                                         const std::vector<std::string>& warnings,
                                         const std::string& fine) {
  DiagnosticStatusWrapper status;
  status.name = name;
  status.hardware_id = "none";
  if (!failure.empty()) {
    status.summary(DiagnosticStatus::ERROR, failure);
  } else if (!warnings.empty()) {
    status.summary(DiagnosticStatus::WARN, fmt::format("{}", fmt::join(warnings, "; ")));
  } else {
    status.summary(DiagnosticStatus::OK, fine);
  }
  return status;
}

std::string state_of(const Simulation& simulation) {
  return simulation.paused() ? "paused" : "running";
}

std::string backend_text(const StepReport& report) {
  const std::string why =
      report.backend_reason.empty() ? "" : " (auto: " + report.backend_reason + ")";
  return std::string(report.backend) + why;
}

DiagnosticStatusWrapper diagnostics_of_body(const Simulation& simulation,
                                            const StepStatistics& statistics, std::size_t index,
                                            const std::string& node) {
  const Body& body = simulation.world().bodies()[index];
  const StepReport& report = body.report;
  // Reports of a step that was undone tell of it until the next one.
  const std::string failure = simulation.failure().empty() ? "" : report.failure;
  DiagnosticStatusWrapper status = make_diagnostics(
      node + ": body " + body.name, failure, statistics.warnings(index), state_of(simulation));
  status.add("model", std::string(body.model->name()));
  status.add("solver", std::string(body.solver->name()));
  const std::string_view integration = time_integration_of(body);
  if (!integration.empty()) status.add("time integration", std::string(integration));
  status.add("backend", backend_text(report));
  status.add("iterations", report.iterations);
  status.add("error", report.error ? fmt::format("{:.3g}", *report.error) : "not estimated");
  status.add("contacts", report.contacts);
  return status;
}

/// What stands, and what the steps said.
std::vector<std::string> all_warnings(const Simulation& simulation,
                                      const StepStatistics& statistics) {
  std::vector<std::string> warnings = simulation.warnings();
  for (std::string& warning : statistics.warnings()) warnings.push_back(std::move(warning));
  return warnings;
}

/// Bodies that a GPU was asked for and that the CPU moves; their steps say it once.
void add_backend_warnings(const World& world, std::vector<std::string>& warnings) {
  for (const Body& body : world.bodies()) {
    const ParameterText& given = body.solver_setting.second;
    const auto backend = given.find("backend");
    if (backend == given.end() || backend->second != "cuda") continue;
    if (world.steps() == 0 || body.report.backend == "cuda") continue;
    const std::string reason = why_no_cuda();
    warnings.push_back(
        fmt::format("body '{}' is moved by the CPU, though its solver's backend is "
                    "'cuda'{}",
                    body.name, reason.empty() ? "" : ": " + reason));
  }
}

/// What stays as long as the scene does.
DiagnosticStatusWrapper diagnostics_of_scene(const Simulation& simulation,
                                             const std::string& node) {
  std::vector<std::string> warnings = simulation.warnings();
  add_backend_warnings(simulation.world(), warnings);
  DiagnosticStatusWrapper status = make_diagnostics(node + ": scene", "", warnings, "no warnings");
  status.add("file", simulation.spec().path);
  for (std::size_t w = 0; w < warnings.size(); ++w) {
    status.add(fmt::format("warning {}", w + 1), warnings[w]);
  }
  return status;
}

/// The master and who else is there.
DiagnosticStatusWrapper diagnostics_of_ros(const Simulation& simulation, const std::string& node) {
  return make_diagnostics(node + ": ROS", "", simulation.notices().all(), "connected");
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
  status.time_integration = std::string(time_integration_of(body));
  status.first_order = std::string(report.first_order);
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
  DiagnosticStatusWrapper status = make_diagnostics(name + ": simulation", simulation.failure(),
                                                    statistics.warnings(), state_of(simulation));
  const World& world = simulation.world();
  status.add("solver", simulation.solvers());
  for (const Body& body : world.bodies()) {
    status.add("backend of " + body.name, backend_text(body.report));
  }
  status.add("simulated time [s]", fmt::format("{:.6g}", world.time()));
  status.add("time step [s]", fmt::format("{:g}", world.time_step()));
  status.add("step time, mean [s]", fmt::format("{:.3g}", statistics.mean_time()));
  status.add("step time, max [s]", fmt::format("{:.3g}", statistics.max_time()));
  status.add("real-time factor", fmt::format("{:.3g}", statistics.real_time_factor()));
  status.add("paused", std::string(simulation.paused() ? "true" : "false"));
  statuses.assign(1, status);
  for (std::size_t b = 0; world.bodies().size() > 1 && b < world.bodies().size(); ++b) {
    statuses.push_back(diagnostics_of_body(simulation, statistics, b, name));
  }
  statuses.push_back(diagnostics_of_scene(simulation, name));
  statuses.push_back(diagnostics_of_ros(simulation, name));
}

}  // namespace pliant
