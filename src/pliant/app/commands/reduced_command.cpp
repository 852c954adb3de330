#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "pliant/app/commands/commands.h"
#include "pliant/app/interrupt.h"
#include "pliant/app/plot.h"
#include "pliant/app/progress_bar.h"
#include "pliant/math/error.h"
#include "pliant/study/experiments/reduced_study.h"
#include "pliant/study/option_text.h"
#include "pliant/study/tables_folder.h"

namespace pliant {
namespace {

constexpr const char* kReducedFooter =
    "Experiments:\n"
    "  1, 2         without and with damping: every body, impulse, constant force for 0.3 s, 1 Hz "
    "sine,\n"
    "               at 1, 2 and 4 times the force: who finishes, energies (runs*.csv, "
    "energy_*.csv)\n"
    "  3            the quadruped for 3,000,000 steps: drift of its energies (long.csv)\n"
    "  4            the beam at three time steps (steps.csv)\n"
    "  thesis       its integrator with its counts of explicit coordinates, and their h w "
    "(thesis.csv)\n"
    "  frequencies  how fast each coordinate rings, and for what time of computing "
    "(frequencies.csv)\n"
    "  speed        time of a step of every integrator (speed.csv)\n"
    "  floor        time of one force against this machine's limits (floor.csv)\n"
    "  pictures     frames, the first second at three steps, a run that blows up (frames.csv,\n"
    "               early.csv, blow_up.csv)\n"
    "  precision    error against time of every integrator (precision.csv)\n"
    "  all          all of these\n"
    "More in docs/reduced.md.";

struct ReducedCommand {
  std::string experiment = "all";
  std::string bodies;
  ReducedStudyOptions study;
  bool progress = false;
  bool no_plot = false;
};

const std::vector<std::string> kExperiments = {
    "1", "2", "3", "4", "thesis", "frequencies", "speed", "floor", "pictures", "precision", "all"};

void check(const ReducedCommand& command) {
  if (std::find(kExperiments.begin(), kExperiments.end(), command.experiment) ==
      kExperiments.end()) {
    throw InputError(unknown_name_message("experiment", command.experiment, kExperiments));
  }
  for (const std::string& name : command.study.bodies) example_body(name);
  if (!(command.study.share > 0.0 && command.study.share <= 1.0)) {
    throw InputError(
        fmt::format("--displacement is {}, but must be > 0 and <= 1", command.study.share));
  }
  if (!(command.study.duration >= 1.0 && command.study.duration <= 1e5)) {
    throw InputError(
        fmt::format("--duration is {}, but must be from 1 to 1e5 s", command.study.duration));
  }
  if (command.study.long_steps < 1000) throw InputError("--steps must be at least 1000");
}

bool run_experiment(const std::string& name, const ReducedStudyOptions& options,
                    const ReducedParts& parts, const StudyProgress& progress) {
  if (name == "1") return study_reduced_runs(options, parts, 0.0, progress);
  if (name == "2") return study_reduced_runs(options, parts, 0.3, progress);
  if (name == "3") return study_reduced_long(options, parts, progress);
  if (name == "4") return study_reduced_steps(options, parts, progress);
  if (name == "thesis") return study_reduced_thesis(options, parts, progress);
  if (name == "frequencies") return study_reduced_frequencies(options, parts, progress);
  if (name == "speed") return study_reduced_speed(options, parts, progress);
  if (name == "floor") return study_reduced_floor(options, progress);
  if (name == "pictures") return study_reduced_pictures(options, progress);
  return study_reduced_precision(options, parts, progress);
}

int study_reduced(ReducedCommand command) {
  command.study.bodies =
      command.bodies.empty() ? thesis_body_names() : parse_names(command.bodies, "--bodies");
  check(command);
  claim_tables_folder(command.study.folder, "reduced");
  const ReducedParts parts(command.study.folder, settings_of(command.study));
  if (parts.started_afresh()) {
    std::cerr << command.study.folder << ": what is there was made with other options: afresh\n";
  }
  catch_interrupts();
  ProgressBar bar(command.progress || isatty(STDERR_FILENO) != 0);
  for (const std::string& name : kExperiments) {
    if (name == "all" || (command.experiment != "all" && command.experiment != name)) continue;
    const bool is_done = run_experiment(name, command.study, parts,
                                        [&](double done, double total, const std::string& what) {
                                          bar.update(done, total, name + ": " + what);
                                          return !interrupted();
                                        });
    if (!is_done) {
      bar.clear();
      std::cerr << "interrupted in experiment " << name
                << ": the same command goes on after its last finished part\n";
      return kInterrupted;
    }
  }
  bar.clear();
  const bool has_pictures = !command.no_plot && plot_reduced(command.study.folder);
  fmt::print("written: tables{} in {}\n", has_pictures ? " and pictures" : "",
             command.study.folder);
  std::fflush(stdout);
  return kOk;
}

}  // namespace

void add_reduced_command(CLI::App& study, int& exit_code) {
  CLI::App* command =
      add_command(study, "reduced", "Repeat the thesis's experiments with reduced bodies");
  command->footer(std::string(kReducedFooter) + "\n\n" + command->get_footer());
  auto options = std::make_shared<ReducedCommand>();
  command->add_option("--experiment", options->experiment, "Which one [all]")->type_name("NAME");
  command->add_option("--out", options->study.folder, "Folder for tables and pictures")
      ->required()
      ->type_name("DIR");
  command->add_option("--bodies", options->bodies, "Which bodies; all without it")
      ->type_name("A,B,...");
  command->add_option("--displacement", options->study.share,
                      "Largest displacement over body size that sets the force [0.1]");
  command->add_option("--duration", options->study.duration, "Of experiments 1 and 2 [30 s]");
  command->add_option("--steps", options->study.long_steps, "Of experiment 3 [3000000]");
  command->add_flag("--no-plot", options->no_plot, "Draw no pictures");
  command->add_flag("--progress", options->progress,
                    "Show the bar where stderr is no terminal too");
  command->callback([options, &exit_code] { exit_code = study_reduced(*options); });
}

}  // namespace pliant
