#include <fmt/format.h>

#include <memory>

#include "pliant/app/accuracy_report.h"
#include "pliant/app/commands/commands.h"
#include "pliant/app/plot.h"
#include "pliant/app/study_run.h"

namespace pliant {
namespace {

constexpr const char* kAccuracyFooter =
    "Step error (always): two converged references run the scene; from --samples states of it\n"
    "every solver makes one step. error = |x - x*| / |y - x*| with the converged step x* and the\n"
    "step y without elasticity, contact and air, mass-weighted over all vertices: 1 is as bad as\n"
    "no solver, 1e-3 misses a thousandth of what a solver has to do. The largest error counts.\n"
    "Run error (with --dt): whole runs at each of these time steps against a reference that\n"
    "is extrapolated from smaller ones. error = |x - x*| / |x* - x(0)| at the end: it contains "
    "what the "
    "time\n"
    "step costs in accuracy. Explicit solvers take the steps at which they are stable.\n"
    "DIR gets accuracy.csv, accuracy.yaml (the settings), accuracy.png and .svg; a study that was\n"
    "stopped goes on when the same command is called again. More in docs/accuracy.md.";

struct AccuracyCommand {
  StudyOptions study;
  bool no_plot = false;
};

int study_accuracy(const AccuracyCommand& options) {
  const SceneSpec scene = load_study_scene(options.study);
  const AccuracyPlan plan = make_accuracy_plan(scene, accuracy_options(options.study, {}));
  StudyFolder folder = open_study_folder(options.study, plan);
  const int code = measure_study(plan, options.study.shows_progress(), folder);
  if (code != kOk) return code;
  fmt::print("{}", accuracy_report(plan, folder.rows()));
  std::fflush(stdout);
  if (folder.directory().empty()) return code;
  const bool has_picture = !options.no_plot && plot_accuracy(folder.directory());
  fmt::print("written: {}{}\n", folder.table_path(),
             has_picture
                 ? fmt::format(", {0}/accuracy.png and {0}/accuracy.svg", folder.directory())
                 : "");
  std::fflush(stdout);
  return code;
}

}  // namespace

void add_accuracy_command(CLI::App& study, int& exit_code) {
  CLI::App* command = add_command(
      study, "accuracy", "Measure error and time of every solver against a converged reference");
  command->footer(std::string(kAccuracyFooter) + "\n\n" + command->get_footer());
  auto options = std::make_shared<AccuracyCommand>();
  add_study_options(*command, options->study);
  command
      ->add_option("--dt", options->study.time_steps,
                   "Measure whole runs too, at these time steps [s]")
      ->type_name("S,S,...");
  command
      ->add_option("--time-integrations", options->study.time_integrations,
                   "Measure these whole runs by each of these; see `pliant list time_integrations`")
      ->type_name("A,B,...");
  command
      ->add_option("--out", options->study.out,
                   "Folder for the table and the picture; nothing is written without it")
      ->type_name("DIR");
  command->add_flag("--no-plot", options->no_plot, "Draw no picture");
  command->callback([options, &exit_code] { exit_code = study_accuracy(*options); });
}

}  // namespace pliant
