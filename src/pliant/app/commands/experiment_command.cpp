#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "pliant/app/commands/commands.h"
#include "pliant/app/interrupt.h"
#include "pliant/app/plot.h"
#include "pliant/app/progress_bar.h"
#include "pliant/core/parallel/parallel.h"
#include "pliant/geometry/io/folder_lock.h"
#include "pliant/math/error.h"
#include "pliant/study/experiments/cloth_study.h"
#include "pliant/study/experiments/viscoelastic_study.h"
#include "pliant/study/tables_folder.h"

namespace pliant {
namespace {

/// A study that is a row of experiments.
struct ExperimentStudy {
  std::string name, meaning, sizes;
  const std::vector<Experiment>& experiments;
  bool (*plot)(const std::string& folder);
  bool has_figure = false;
};

struct ExperimentCommand {
  std::string experiment = "all";
  ExperimentOptions study;
  int threads = 1;
  bool progress = false;
  bool no_plot = false;
};

std::string meanings(const ExperimentStudy& study) {
  std::string text = "Experiments:\n";
  for (const Experiment& experiment : study.experiments) {
    text +=
        fmt::format("  {:<14} {} ({}.csv)\n", experiment.name, experiment.meaning, experiment.name);
  }
  return text + fmt::format("  all            all of these\nMore in docs/{}.md.", study.name);
}

void check(const ExperimentStudy& study, const ExperimentCommand& command) {
  std::vector<std::string> names = {"all"};
  for (const Experiment& experiment : study.experiments) {
    names.push_back(experiment.name);
  }
  if (std::find(names.begin(), names.end(), command.experiment) == names.end()) {
    throw InputError(unknown_name_message("experiment", command.experiment, names));
  }
  if (!(command.study.share > 0.0 && command.study.share <= 1.0)) {
    throw InputError(fmt::format("--share is {}, but must be > 0 and <= 1", command.study.share));
  }
}

int run_experiments(const ExperimentStudy& study, const ExperimentCommand& command) {
  check(study, command);
  set_threads(command.threads);
  claim_tables_folder(command.study.folder, study.name);
  const FolderLock lock(command.study.folder);
  ExperimentOptions given = command.study;
  if (given.figure.empty()) given.figure = find_shared("config/meshes/figure.obj");
  catch_interrupts();
  ProgressBar bar(command.progress || isatty(STDERR_FILENO) != 0);
  for (const Experiment& experiment : study.experiments) {
    if (command.experiment != "all" && command.experiment != experiment.name) continue;
    const bool is_done = experiment.run(given, [&](double done, const std::string& what) {
      bar.update(done, 1.0, experiment.name + ": " + what);
      return !interrupted();
    });
    if (!is_done) {
      bar.clear();
      std::cerr << "interrupted in experiment " << experiment.name
                << ": tables of those before it are there\n";
      return kInterrupted;
    }
  }
  bar.clear();
  const bool has_pictures = !command.no_plot && study.plot(command.study.folder);
  fmt::print("written: tables{} in {}\n", has_pictures ? " and pictures" : "",
             command.study.folder);
  std::fflush(stdout);
  return kOk;
}

void add_study(CLI::App& app, const ExperimentStudy& study, int& exit_code) {
  CLI::App* command = add_command(app, study.name, study.meaning);
  command->footer(meanings(study) + "\n\n" + command->get_footer());
  auto options = std::make_shared<ExperimentCommand>();
  command->add_option("--experiment", options->experiment, "Which one [all]")->type_name("NAME");
  command->add_option("--out", options->study.folder, "Folder for tables and pictures")
      ->required()
      ->type_name("DIR");
  command->add_option("--share", options->study.share,
                      fmt::format("Of the {} and steps, for a quick look [1]", study.sizes));
  if (study.has_figure) {
    command
        ->add_option("--figure", options->study.figure,
                     "Closed mesh of the experiments with a figure [config/meshes/figure.obj]")
        ->type_name("MESH");
  }
  command->add_option("--threads", options->threads, "Threads a step may use [1]");
  command->add_flag("--no-plot", options->no_plot, "Draw no pictures");
  command->add_flag("--progress", options->progress,
                    "Show the bar where stderr is no terminal too");
  command->callback([study, options, &exit_code] { exit_code = run_experiments(study, *options); });
}

}  // namespace

void add_cloth_command(CLI::App& study, int& exit_code) {
  add_study(study,
            {"cloth", "Repeat the thesis's experiments with wet cloth and the air under it",
             "thesis's vertices", cloth_experiments(), plot_cloth},
            exit_code);
}

void add_viscoelastic_command(CLI::App& study, int& exit_code) {
  add_study(study,
            {"viscoelastic", "Repeat the paper's experiments with particles from rigid to liquid",
             "paper's particles", viscoelastic_experiments(), plot_viscoelastic, true},
            exit_code);
}

}  // namespace pliant
