#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "pliant/app/commands/commands.h"
#include "pliant/app/study_run.h"
#include "pliant/math/error.h"
#include "pliant/solvers/time/time_integrations.h"
#include "pliant/study/choice.h"
#include "pliant/study/option_text.h"
#include "pliant/study/study_settings.h"

namespace pliant {
namespace {

constexpr const char* kAdviceFooter =
    "Makes a short study of step errors (see `pliant study accuracy --help`), or takes the one in\n"
    "DIR, and prints the cheapest solver that keeps both the error and the budget as the key\n"
    "`solver` of a scene: put it in the place of the scene's own. With --dt it looks at the errors "
    "of\n"
    "whole runs instead, by every time integration, and prints `time_step` and `time_integration`\n"
    "with the solver: the cheapest for a simulated second. When there is none, it prints\n"
    "as comments what is the best within the budget and what the error would cost.\n"
    "Exit code 4: nothing that was measured keeps both.";

struct AdviseCommand {
  StudyOptions study;
  double error = 0.0;
  std::optional<std::string> budget;
};

AccuracyOptions short_study() {
  AccuracyOptions options;
  options.samples = 3;
  return options;
}

/// Time integrations that all bodies' models take; none where one takes none.
std::vector<std::string> suitable_integrations(const SceneSpec& scene) {
  std::vector<std::string> names = time_integrations().names();
  for (const BodySpec& body : scene.bodies) {
    const std::vector<std::string> fit = time_integrations().names_for(body.model.name);
    const auto is_unfit = [&](const std::string& name) {
      return std::find(fit.begin(), fit.end(), name) == fit.end();
    };
    names.erase(std::remove_if(names.begin(), names.end(), is_unfit), names.end());
  }
  return names;
}

/// Those of the study in the folder when it is of this scene and the arguments ask for no other.
AccuracyOptions advise_options(const AdviseCommand& options, const SceneSpec& scene) {
  const std::string& out = options.study.out;
  const std::string settings =
      out.empty() || options.study.overwrite ? "" : StudyFolder::settings_in(out);
  if (!settings.empty() && !options.study.says_what()) {
    const auto there = options_from_settings(settings, out + "/accuracy.yaml", scene_hash(scene));
    if (there) return *there;
  }
  AccuracyOptions asked = accuracy_options(options.study, short_study());
  if (!asked.time_steps.empty() && asked.time_integrations.empty()) {
    asked.time_integrations = suitable_integrations(scene);
  }
  return asked;
}

std::string with_prefix(const std::string& text, const std::string& prefix) {
  std::string result = prefix;
  for (std::size_t i = 0; i < text.size(); ++i) {
    result += text[i];
    if (text[i] == '\n' && i + 1 < text.size()) result += prefix;
  }
  return result;
}

std::string snippet(const AccuracyPlan& plan, const AccuracyRow& row) {
  SolverSetting setting = solver_setting(plan.scene, row.solver, row.iterations);
  if (row.measure == Measure::kStep) return scene_snippet(setting);
  if (takes_iterations(row.solver)) setting.time_integration = row.time_integration;
  return fmt::format("time_step: {:g}\n{}", row.time_step, scene_snippet(setting));
}

/// Whole runs, where there are any: what is asked for.
Measure measure_of(const AccuracyPlan& plan) {
  return plan.options.time_steps.empty() ? Measure::kStep : Measure::kRun;
}

std::string price(const AccuracyRow& row) {
  if (row.measure == Measure::kRun) {
    return fmt::format("error of the run {:.2e}, {:.3g} s a simulated second, {:.3g} ms a step",
                       sure_error(row), cost(row), 1e3 * row.step_seconds);
  }
  return fmt::format("error {:.2e}, {:.3g} ms a step, {:.3g} ms at most", sure_error(row),
                     1e3 * row.step_seconds, 1e3 * row.longest_seconds);
}

std::string refusal(const AccuracyPlan& plan, const std::vector<AccuracyRow>& rows, double error,
                    double budget) {
  std::string text = "# Nothing that was measured keeps both the error and the budget.\n";
  if (const auto best = most_accurate(rows, measure_of(plan), budget)) {
    text += fmt::format("# The best within the budget ({}):\n{}", price(*best),
                        with_prefix(snippet(plan, *best), "#   "));
  } else {
    text += "# No solver keeps the budget, not even with the fewest iterations measured.\n";
  }
  if (const auto cheap = cheapest(rows, measure_of(plan), error)) {
    text += fmt::format("# What the error costs ({}):\n{}", price(*cheap),
                        with_prefix(snippet(plan, *cheap), "#   "));
  } else if (rows.back().disagreement > error) {
    // Those of runs, where there are any, come last.
    text += fmt::format("# The references disagree by {:.2e}: smaller errors cannot be told.\n",
                        rows.back().disagreement);
  } else {
    text += "# No solver keeps the error with the iterations measured: try more --iterations.\n";
  }
  return text;
}

int advise(const AdviseCommand& options) {
  if (!(options.error > 0.0 && std::isfinite(options.error))) {
    throw InputError(fmt::format("--error is {:g}, but must be > 0 and finite, for example 1e-3",
                                 options.error));
  }
  const double budget = options.budget ? parse_wall_time(*options.budget, "--budget")
                                       : std::numeric_limits<double>::infinity();
  const SceneSpec scene = load_study_scene(options.study);
  const AccuracyPlan plan = make_accuracy_plan(scene, advise_options(options, scene));
  StudyFolder folder = open_study_folder(options.study, plan);
  const int code = measure_study(plan, options.study.shows_progress(), folder);
  if (code != kOk) return code;
  const auto choice = cheapest(folder.rows(), measure_of(plan), options.error, budget);
  fmt::print("{}", choice ? fmt::format("# {}\n{}", price(*choice), snippet(plan, *choice))
                          : refusal(plan, folder.rows(), options.error, budget));
  std::fflush(stdout);
  return choice ? kOk : kNoAnswer;
}

}  // namespace

void add_advise_command(CLI::App& study, int& exit_code) {
  CLI::App* command = add_command(
      study, "advise", "Name the cheapest solver for an error and a time that a step may take");
  command->footer(std::string(kAdviceFooter) + "\n\n" + command->get_footer());
  auto options = std::make_shared<AdviseCommand>();
  add_study_options(*command, options->study);
  command
      ->add_option("--error", options->error,
                   "Largest error of a step, or with --dt of a run, as `study accuracy` defines it")
      ->required()
      ->type_name("E");
  command
      ->add_option("--dt", options->study.time_steps,
                   "Look at whole runs, at these time steps [s], by every time integration")
      ->type_name("S,S,...");
  command
      ->add_option("--time-integrations", options->study.time_integrations,
                   "By these alone; see `pliant list time_integrations`")
      ->type_name("A,B,...");
  command
      ->add_option("--budget", options->budget,
                   "Longest time a step may take: 16ms, 0.016s or 500us; any without it")
      ->type_name("TIME");
  command
      ->add_option("--out", options->study.out,
                   "Folder to keep the study in, or one with a study of this scene to use")
      ->type_name("DIR");
  command->callback([options, &exit_code] { exit_code = advise(*options); });
}

}  // namespace pliant
