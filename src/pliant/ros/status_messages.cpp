#include "pliant/ros/status_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {
namespace {

void fill_scene(const Simulation& simulation, SolverStatus& status) {
  const World& world = simulation.world();
  const Body& body = world.bodies().front();
  status.model = std::string(body.model->name());
  status.solver = simulation.solver();
  status.backend = std::string(body.report.backend);
  status.effects.clear();
  for (const auto& effect : body.effects) status.effects.emplace_back(effect->name());
  status.step = world.steps();
  status.sim_time = world.time();
  status.time_step = world.time_step();
  status.vertices = 0;
  status.total_mass = 0.0;
  for (const Body& each : world.bodies()) {
    status.vertices += static_cast<std::uint32_t>(each.particles().size());
    status.total_mass += each.particles().mass.sum();
  }
}

void fill_last_step(const World& world, SolverStatus& status) {
  status.iterations = status.contacts = 0;
  status.residual = 0.0;
  status.error = status.impulse_imbalance = -1.0;
  status.energy_gained = std::numeric_limits<double>::quiet_NaN();
  for (const Body& body : world.bodies()) {
    const StepReport& report = body.report;
    status.iterations = std::max(status.iterations, static_cast<std::uint32_t>(report.iterations));
    status.contacts += static_cast<std::uint32_t>(report.contacts);
    status.residual = std::max(status.residual, report.residual);
    status.error = std::max(status.error, report.error.value_or(-1.0));
    status.impulse_imbalance =
        std::max(status.impulse_imbalance, report.impulse_imbalance.value_or(-1.0));
    if (!report.energy_gained) continue;
    const bool is_first = std::isnan(status.energy_gained);
    status.energy_gained = *report.energy_gained + (is_first ? 0.0 : status.energy_gained);
  }
  const StepReport& first = world.bodies().front().report;
  status.ended_by = std::string(to_string(first.ended_by));
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

void fill_level(const Simulation& simulation, const StepStatistics& statistics,
                diagnostic_msgs::DiagnosticStatus& status) {
  if (!simulation.failure().empty()) {
    status.level = diagnostic_msgs::DiagnosticStatus::ERROR;
    status.message = simulation.failure();
  } else if (!statistics.warnings().empty()) {
    status.level = diagnostic_msgs::DiagnosticStatus::WARN;
    status.message = fmt::format("{}", fmt::join(statistics.warnings(), "; "));
  } else {
    status.level = diagnostic_msgs::DiagnosticStatus::OK;
    status.message = simulation.paused() ? "paused" : "running";
  }
}

}  // namespace

void fill_status(const Simulation& simulation, const StepStatistics& statistics,
                 SolverStatus& status) {
  fill_scene(simulation, status);
  fill_last_step(simulation.world(), status);
  fill_cost(statistics, status);
  status.warnings = statistics.warnings();
  if (!simulation.failure().empty()) status.warnings.push_back(simulation.failure());
  status.paused = simulation.paused();
}

void fill_diagnostics(const Simulation& simulation, const StepStatistics& statistics,
                      const std::string& node, diagnostic_msgs::DiagnosticStatus& status) {
  status.name = node.substr(node.find_first_not_of('/')) + ": simulation";
  status.hardware_id = "none";
  fill_level(simulation, statistics, status);
  status.values.clear();
  add_value("solver", simulation.solver(), status);
  for (const Body& body : simulation.world().bodies()) {
    const StepReport& report = body.report;
    const std::string why =
        report.backend_reason.empty() ? "" : " (auto: " + report.backend_reason + ")";
    add_value("backend of " + body.name, std::string(report.backend) + why, status);
  }
  add_value("simulated time [s]", fmt::format("{:.6g}", simulation.world().time()), status);
  add_value("time step [s]", fmt::format("{:g}", simulation.world().time_step()), status);
  add_value("step time, mean [s]", fmt::format("{:.3g}", statistics.mean_time()), status);
  add_value("step time, max [s]", fmt::format("{:.3g}", statistics.max_time()), status);
  add_value("real-time factor", fmt::format("{:.3g}", statistics.real_time_factor()), status);
  add_value("paused", simulation.paused() ? "true" : "false", status);
}

}  // namespace pliant
