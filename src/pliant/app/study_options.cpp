#include "pliant/app/study_options.h"

#include <unistd.h>

#include "pliant/study/option_text.h"

namespace pliant {

bool StudyOptions::shows_progress() const { return progress || isatty(STDERR_FILENO) != 0; }

bool StudyOptions::says_what() const {
  return solvers || iterations || time_steps || time_integrations || references || steps ||
         duration || samples || repeats;
}

void add_study_options(CLI::App& command, StudyOptions& options) {
  command.add_option("scene", options.scene.path, "Scene file (YAML)")
      ->required()
      ->type_name("SCENE");
  command
      .add_option("--solvers", options.solvers,
                  "Which solvers; `all`, as without it: those that suit the scene")
      ->type_name("A,B,...");
  command
      .add_option("--iterations", options.iterations,
                  "Iteration counts to measure [1,2,4,8,16,32,64,128,256]")
      ->type_name("N,M,...");
  command
      .add_option("--references", options.references,
                  "The two solvers whose converged results check each other; the most exact ones "
                  "unless this says")
      ->type_name("A,B");
  command.add_option("--steps", options.steps, "How many time steps of the scene to cover")
      ->type_name("N");
  command.add_option("--duration", options.duration, "Or how long a time of the scene [s]")
      ->type_name("S");
  command.add_option("--samples", options.samples, "How many states of the run to measure from")
      ->type_name("N");
  command
      .add_option("--repeats", options.repeats,
                  "How often to time each step, unless that takes long; the median is taken [5]")
      ->type_name("N");
  command.add_option("--time-step", options.scene.time_step,
                     "Another time step than the scene's [s]");
  command.add_option("--threads", options.scene.threads,
                     "Threads a step may use; errors stay the same");
  command.add_flag("--overwrite", options.overwrite, "Replace a study that is in DIR");
  command.add_flag("--progress", options.progress, "Show the bar where stderr is no terminal too");
}

AccuracyOptions accuracy_options(const StudyOptions& options, AccuracyOptions defaults) {
  AccuracyOptions study = std::move(defaults);
  if (options.solvers) study.solvers = parse_names(*options.solvers, "--solvers");
  if (options.iterations) study.iterations = parse_counts(*options.iterations, "--iterations");
  if (options.time_steps) study.time_steps = parse_time_steps(*options.time_steps, "--dt");
  if (options.time_integrations) {
    study.time_integrations = parse_names(*options.time_integrations, "--time-integrations");
  }
  if (options.references) study.references = parse_names(*options.references, "--references");
  if (options.steps || options.duration) {
    study.steps = options.steps;
    study.duration = options.duration;
  }
  study.samples = options.samples.value_or(study.samples);
  study.repeats = options.repeats.value_or(study.repeats);
  return study;
}

}  // namespace pliant
