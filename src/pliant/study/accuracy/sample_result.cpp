#include "pliant/study/accuracy/sample_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "pliant/models/solver_registry.h"
#include "pliant/study/step_times.h"

namespace pliant {

double set_solver(const SolverSetting& solver, World& world) {
  const Timer timer;
  for (Body& body : world.bodies()) {
    world.set_solver(body, all_solvers(), solver.name, solver.parameters,
                     "solver '" + solver.name + "'");
  }
  return timer.seconds();
}

Errors infinite_errors() {
  const double infinity = std::numeric_limits<double>::infinity();
  return {infinity, infinity, infinity, infinity, infinity};
}

void add_reports(const World& world, SampleResult& result) {
  for (const Body& body : world.bodies()) {
    result.residual = std::max(result.residual, body.report.residual);
    result.iterations = std::max(result.iterations, 1.0 * body.report.iterations);
  }
}

AccuracyRow summary(const PlannedRow& planned, const std::vector<SampleResult>& samples) {
  AccuracyRow row;
  row.measure = planned.measure;
  row.solver = planned.solver.name;
  row.time_integration = planned.time_integration;
  row.iterations = planned.solver.iterations;
  row.time_step = planned.time_step;
  std::vector<double> errors, seconds, wall, prepare;
  for (const SampleResult& sample : samples) {
    row.is_finite = row.is_finite && sample.is_finite;
    errors.push_back(sample.errors.position);
    seconds.push_back(sample.step_seconds);
    wall.push_back(sample.wall_seconds);
    prepare.push_back(sample.prepare_seconds);
    row.error = std::max(row.error, sample.errors.position);
    row.rms = std::max(row.rms, sample.errors.rms);
    row.largest = std::max(row.largest, sample.errors.largest);
    row.energy_error = std::max(row.energy_error, sample.errors.energy);
    row.strain_error = std::max(row.strain_error, sample.errors.strain);
    row.residual = std::max(row.residual, sample.residual);
    row.used_iterations = std::max(row.used_iterations, sample.iterations);
    row.longest_seconds = std::max(row.longest_seconds, sample.longest_seconds);
  }
  row.states = static_cast<double>(samples.size());
  row.median_error = median_of(errors);
  row.step_seconds = median_of(seconds);
  row.wall_seconds = median_of(wall);
  row.prepare_seconds = median_of(prepare);
  row.seconds_per_second = row.step_seconds / row.time_step;
  return row;
}

std::string label(const PlannedRow& planned) {
  const std::string iterations = planned.solver.iterations == 0
                                     ? ""
                                     : fmt::format(", {} iterations", planned.solver.iterations);
  return fmt::format("{}{}, {} of {:g} s", planned.solver.label(), iterations,
                     planned.measure == Measure::kStep ? "one step" : "steps", planned.time_step);
}

}  // namespace pliant
