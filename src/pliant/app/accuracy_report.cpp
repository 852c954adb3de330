#include "pliant/app/accuracy_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "pliant/study/choice.h"
#include "pliant/study/step_study.h"

namespace pliant {
namespace {

constexpr double kErrors[] = {1e-1, 1e-2, 1e-3, 1e-4};
/// Wall over processor time above which it is worth telling.
constexpr double kBusy = 1.25;

std::string iterations_text(const AccuracyRow& row) {
  return row.iterations == 0 ? "-" : std::to_string(row.iterations);
}

std::string note(const AccuracyRow& row) {
  if (!row.is_finite) return "not finite";
  return row.is_resolved() ? "" : "not resolved";
}

std::string table(const std::vector<AccuracyRow>& rows) {
  std::size_t width = 16, integration = 16;
  for (const AccuracyRow& row : rows) {
    width = std::max(width, row.solver.size());
    integration = std::max(integration, row.time_integration.size());
  }
  std::string text =
      fmt::format("  {:<{}} {:<{}} {:>10} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10}\n", "solver",
                  width, "time_integration", integration, "iterations", "dt [s]", "error",
                  "rms [m]", "energy", "strain", "residual", "step [ms]");
  for (const AccuracyRow& row : rows) {
    text += fmt::format(
        "  {:<{}} {:<{}} {:>10} {:>9.3g} {:>9.2e} {:>9.2e} {:>9.2e} {:>9.2e} {:>9.2e} {:>10.4f}  "
        "{}\n",
        row.solver, width, row.time_integration, integration, iterations_text(row), row.time_step,
        row.error, row.rms, row.energy_error, row.strain_error, row.residual,
        1e3 * row.step_seconds, note(row));
  }
  return text;
}

std::string agreement(const AccuracyPlan& plan, const std::vector<AccuracyRow>& rows,
                      Measure measure) {
  const auto& names = plan.options.references;
  const double disagreement = rows.front().disagreement;
  std::string text =
      measure == Measure::kStep
          ? fmt::format("The references {} and {} differ by {:.2e}", names[0], names[1],
                        disagreement)
          : fmt::format(
                "The reference, from {0} at {2:g} s, {1} at {3:g} s and {0} at {4:g} s, is "
                "known to {5:.2e}",
                names[0], names[1], plan.reference_time_step, 2.0 * plan.reference_time_step,
                4.0 * plan.reference_time_step, disagreement);
  text += "; errors below twice that are not resolved.\n";
  const double left_out = plan.options.samples - rows.front().states;
  if (measure == Measure::kStep && left_out > 0) {
    text += fmt::format(
        "{:.0f} of the {} states are left out, since the references differ by more than {:g} "
        "there: the step has more than one solution, or one that they do not find.\n",
        left_out, plan.options.samples, kGoodAgreement);
  }
  if (measure == Measure::kStep && !(disagreement <= kGoodAgreement)) {
    text += fmt::format(
        "WARNING: on most states they differ by more than {:g}: one of them does not converge on "
        "this scene, or its steps have more than one solution.\n",
        kGoodAgreement);
  }
  return text;
}

std::string cheapest_lines(const std::vector<AccuracyRow>& rows, Measure measure) {
  const bool is_step = measure == Measure::kStep;
  std::string text = "Cheapest for an error of at most\n";
  for (double error : kErrors) {
    const auto row = cheapest(rows, measure, error);
    if (!row) {
      text += fmt::format("  {:<6g}  none measured\n", error);
      continue;
    }
    const std::string iterations =
        row->iterations == 0 ? "" : fmt::format(", {} iterations", row->iterations);
    text += is_step ? fmt::format("  {:<6g}  {}{}: {:.4f} ms a step\n", error, row->solver,
                                  iterations, 1e3 * cost(*row))
                    : fmt::format("  {:<6g}  {} by {}{}, dt {:g} s: {:.4f} s a simulated second\n",
                                  error, row->solver, row->time_integration, iterations,
                                  row->time_step, cost(*row));
  }
  return text;
}

std::string busy_note(const std::vector<AccuracyRow>& rows) {
  double wall = 0.0, time = 0.0;
  for (const AccuracyRow& row : rows) {
    wall += row.wall_seconds;
    time += row.step_seconds;
  }
  if (wall <= kBusy * time) return {};
  return fmt::format(
      "note: the machine was busy: steps took {:.1f} times as long by the clock; the times above "
      "are processor times\n",
      wall / time);
}

std::string section(const AccuracyPlan& plan, const std::vector<AccuracyRow>& all,
                    Measure measure) {
  std::vector<AccuracyRow> rows;
  std::copy_if(all.begin(), all.end(), std::back_inserter(rows),
               [&](const AccuracyRow& row) { return row.measure == measure; });
  if (rows.empty()) return {};
  const std::string title =
      measure == Measure::kStep
          ? fmt::format(
                "Step error: one step of {:g} s from {} states of {:g} s of the scene; the "
                "largest error counts.\n",
                plan.scene.time_step, plan.options.samples, plan.duration)
          : fmt::format("Run error: the end of whole runs of {:g} s.\n", plan.duration);
  return title + table(rows) + agreement(plan, rows, measure) + cheapest_lines(rows, measure) +
         "\n";
}

}  // namespace

std::string accuracy_report(const AccuracyPlan& plan, const std::vector<AccuracyRow>& rows) {
  std::string text = section(plan, rows, Measure::kStep) + section(plan, rows, Measure::kRun);
  text += busy_note(rows);
  for (const std::string& line : plan.notes) text += "note: " + line + "\n";
  return text;
}

}  // namespace pliant
