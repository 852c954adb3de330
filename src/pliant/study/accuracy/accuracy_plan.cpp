#include "pliant/study/accuracy/accuracy_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "pliant/core/step/time_integration.h"
#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"
#include "pliant/solvers/time/time_integrations.h"
#include "pliant/study/accuracy/reference_solvers.h"
#include "pliant/study/experiments/explicit_steps.h"

namespace pliant {
namespace {

constexpr double kDefaultDuration = 1.0;  // [s]
constexpr double kMaxSteps = 1e6;
constexpr int kMaxSamples = 1000;

bool has_parameter(const std::string& solver, const std::string& parameter) {
  const auto& specs = all_solvers().find(solver).parameters;
  return std::any_of(specs.begin(), specs.end(),
                     [&](const ParameterSpec& spec) { return spec.name == parameter; });
}

/// Those that suit every body's model, in the registry's order.
std::vector<std::string> suitable_solvers(const SceneSpec& scene) {
  std::vector<std::string> names = all_solvers().names();
  for (const BodySpec& body : scene.bodies) {
    const std::vector<std::string> fit = all_solvers().names_for(body.model.name);
    const auto is_unfit = [&](const std::string& name) {
      return std::find(fit.begin(), fit.end(), name) == fit.end();
    };
    names.erase(std::remove_if(names.begin(), names.end(), is_unfit), names.end());
  }
  return names;
}

void check_solvers(const SceneSpec& scene, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    for (const BodySpec& body : scene.bodies) all_solvers().find_for(name, body.model.name);
  }
}

/// The number of steps of `time_step` in `duration`.
int count_steps(double duration, double time_step, const std::string& option) {
  const double steps = duration / time_step;
  const double whole = std::max(1.0, std::round(steps));
  if (std::abs(steps - whole) > 1e-6 * whole) {
    throw InputError(
        fmt::format("{}: {:g} s is no whole number of steps of {:g} s; {:g} s would be", option,
                    duration, time_step, duration / std::ceil(steps)));
  }
  if (whole > kMaxSteps) {
    throw InputError(
        fmt::format("{}: {:g} s makes {:.0f} steps of {:g} s, but at most {:.0f} are "
                    "allowed",
                    option, duration, whole, time_step, kMaxSteps));
  }
  return static_cast<int>(whole);
}

void set_duration(AccuracyPlan& plan) {
  AccuracyOptions& options = plan.options;
  const double step = plan.scene.time_step;
  if (options.steps && options.duration) throw InputError("give either --steps N or --duration S");
  if (options.steps && !(*options.steps >= 1.0 && *options.steps <= kMaxSteps &&
                         *options.steps == std::floor(*options.steps))) {
    throw InputError(fmt::format("--steps is {:g}, but must be a whole number from 1 to {:.0f}",
                                 *options.steps, kMaxSteps));
  }
  if (options.duration && !(*options.duration > 0.0 && std::isfinite(*options.duration))) {
    throw InputError(
        fmt::format("--duration is {:g} s, but must be > 0 and finite", *options.duration));
  }
  // A duration that the user did not choose may be rounded to whole steps.
  const double chosen = options.steps ? *options.steps * step
                                      : std::max(1.0, std::round(kDefaultDuration / step)) * step;
  plan.steps = count_steps(options.duration.value_or(chosen), step, "--duration");
  plan.duration = plan.steps * step;
  options.steps = plan.steps;
  options.duration.reset();
}

void check_counts(const AccuracyPlan& plan) {
  const AccuracyOptions& options = plan.options;
  if (options.iterations.empty())
    throw InputError("--iterations is empty; write for example 1,2,4");
  if (options.samples < 1 || options.samples > std::min(kMaxSamples, plan.steps)) {
    throw InputError(fmt::format(
        "--samples is {}, but must be 1 to {} (no more than the {} steps of the scene); a longer "
        "--duration allows more",
        options.samples, std::min(kMaxSamples, plan.steps), plan.steps));
  }
  if (options.repeats < 1 || options.repeats > kMaxSamples) {
    throw InputError(
        fmt::format("--repeats is {}, but must be 1 to {}", options.repeats, kMaxSamples));
  }
}

/// One row for each iteration count; one in all for a solver that takes none.
void add_rows(Measure measure, const std::string& solver, double time_step, AccuracyPlan& plan,
              const std::string& time_integration = "") {
  const auto add = [&](const SolverSetting& setting) {
    plan.rows.push_back({measure, setting, time_step, integration_name(plan.scene, setting)});
  };
  if (!takes_iterations(solver)) {
    add(solver_setting(plan.scene, solver, 0));
    return;
  }
  for (int count : plan.options.iterations) {
    SolverSetting setting = solver_setting(plan.scene, solver, count);
    setting.time_integration = time_integration;
    add(setting);
  }
}

void check_time_integrations(const AccuracyPlan& plan) {
  for (const std::string& name : plan.options.time_integrations) {
    for (const BodySpec& body : plan.scene.bodies) {
      time_integrations().find_for(name, body.model.name);
    }
  }
  if (plan.options.time_integrations.empty() || !plan.options.time_steps.empty()) return;
  throw InputError(
      "--time-integrations is for whole runs: say at which time steps by --dt, for example "
      "0.01,0.005");
}

void add_step_rows(AccuracyPlan& plan) {
  for (const std::string& solver : plan.options.solvers) {
    if (takes_iterations(solver)) {
      add_rows(Measure::kStep, solver, plan.scene.time_step, plan);
    } else if (plan.options.time_steps.empty()) {
      plan.notes.push_back(fmt::format(
          "{0} is explicit: it does not converge to the implicit step, so that only whole runs say "
          "how accurate it is; add --dt {1:g} to measure them",
          solver, plan.scene.time_step));
    }
  }
}

/// Explicit ones, and the integrators of reduced bodies.
bool has_own_integration(const std::string& solver) {
  const std::vector<std::string>& models = all_solvers().find(solver).models;
  return !takes_iterations(solver) ||
         std::all_of(models.begin(), models.end(), [](const std::string& model) {
           return time_integrations().names_for(model).empty();
         });
}

void add_run_rows(AccuracyPlan& plan) {
  const std::vector<double>& listed = plan.options.time_steps;
  if (listed.empty()) return;
  for (double step : listed) count_steps(plan.duration, step, "--dt");
  plan.reference_time_step = listed.back() / kReferenceDivisor;
  count_steps(plan.duration, plan.reference_time_step, "--dt");
  for (const std::string& solver : plan.options.solvers) {
    std::vector<double> steps = listed;
    if (!takes_iterations(solver)) {
      steps = explicit_time_steps(plan.scene, solver_setting(plan.scene, solver, 0), listed);
      plan.notes.push_back(
          fmt::format("{} is explicit: it takes the steps at which it is stable, "
                      "{:g} s",
                      solver, fmt::join(steps, " s, ")));
    }
    for (double step : steps) {
      count_steps(plan.duration, step, "--dt");
      const auto& integrations = plan.options.time_integrations;
      if (integrations.empty() || has_own_integration(solver)) {
        add_rows(Measure::kRun, solver, step, plan);
        continue;
      }
      for (const std::string& name : integrations) {
        add_rows(Measure::kRun, solver, step, plan, name);
      }
    }
  }
}

}  // namespace

std::string integration_name(const SceneSpec& scene, const SolverSetting& solver) {
  if (has_own_integration(solver.name)) return "own";
  if (!solver.time_integration.empty()) return solver.time_integration;
  const bool differ = std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const auto& body) {
    return body.time_integration.has_value();
  });
  if (differ) return "bodies'";
  return scene.time_integration ? scene.time_integration->name : std::string(kImplicitEuler);
}

bool takes_iterations(const std::string& solver) { return has_parameter(solver, "iterations"); }

SolverSetting solver_setting(const SceneSpec& scene, const std::string& name, int iterations) {
  SolverSetting setting{name, {}, takes_iterations(name) ? iterations : 0};
  if (scene.solver.name == name) setting.parameters = scene.solver.parameters;
  for (const char* rule : {"iterations", "tolerance", "budget"}) setting.parameters.erase(rule);
  if (setting.iterations > 0) setting.parameters["iterations"] = std::to_string(iterations);
  return setting;
}

SceneSpec scene_with(const SceneSpec& scene, const SolverSetting& solver, double time_step) {
  SceneSpec changed = scene;
  changed.solver = {solver.name, solver.parameters, "solver '" + solver.name + "'"};
  changed.time_step = time_step;
  const std::string& integration = solver.time_integration;
  if (!integration.empty()) {
    changed.time_integration = {integration, {}, "time_integration '" + integration + "'"};
    for (BodySpec& body : changed.bodies) body.time_integration.reset();
  } else if (has_own_integration(solver.name)) {
    changed.time_integration.reset();
    for (BodySpec& body : changed.bodies) body.time_integration.reset();
  }
  return changed;
}

AccuracyPlan make_accuracy_plan(const SceneSpec& scene, const AccuracyOptions& options) {
  AccuracyPlan plan;
  plan.scene = scene;
  plan.options = options;
  if (plan.options.solvers.empty()) plan.options.solvers = suitable_solvers(scene);
  check_solvers(scene, plan.options.solvers);
  plan.options.references = choose_references(suitable_solvers(scene), options.references);
  check_solvers(scene, plan.options.references);
  plan.runner = runner_setting(scene, suitable_solvers(scene), plan.options.references[0]);
  set_duration(plan);
  check_counts(plan);
  check_time_integrations(plan);
  add_step_rows(plan);
  add_run_rows(plan);
  if (plan.rows.empty()) {
    throw InputError(
        "none of the solvers takes iterations: there is no step error to measure; "
        "give --dt to measure whole runs");
  }
  return plan;
}

}  // namespace pliant
