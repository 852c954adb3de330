#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

#include "pliant/app/batch_run.h"
#include "pliant/app/commands.h"
#include "pliant/app/interrupt.h"
#include "pliant/app/progress_bar.h"
#include "pliant/app/run_statistics.h"
#include "pliant/app/scene_options.h"
#include "pliant/math/error.h"
#include "pliant/scene/recording.h"

namespace pliant {
namespace {

constexpr double kFrameInterval = 1.0 / 30.0;  // of the frames unless the scene says [s]
constexpr double kMaxSteps = 1e12;
constexpr int kMaxScenes = 1000000;
constexpr int kMostInSeries = 50;  // between two looks at Ctrl-C and the bar
constexpr int kMostAtOnce = 1'000'000;

struct RunOptions {
  SceneOptions scene;
  std::optional<double> steps;
  std::optional<double> duration;  // [s]
  std::string out;
  std::optional<int> every;
  bool frames_alone = false;
  bool surface_alone = false;
  bool overwrite = false;
  bool progress = false;
  bool quiet = false;
  std::optional<int> batch;
  std::string vary;
};

std::uint64_t count_steps(const RunOptions& options, double time_step) {
  if (options.steps.has_value() == options.duration.has_value()) {
    throw InputError("give either --steps N or --duration S");
  }
  // Round-off must not add a step to a duration that is a whole number of them.
  const double steps =
      options.steps ? *options.steps : std::ceil(*options.duration / time_step - 1e-6);
  if (!(steps >= 1.0 && steps <= kMaxSteps && steps == std::floor(steps))) {
    throw InputError(fmt::format("{} makes {} steps, but it must be a whole number from 1 to {:g}",
                                 options.steps ? "--steps" : "--duration", steps, kMaxSteps));
  }
  return static_cast<std::uint64_t>(steps);
}

RecordingSpec recording_options(const RunOptions& options, const SceneSpec& scene) {
  RecordingSpec recording;
  recording.every = std::max(1, static_cast<int>(std::lround(kFrameInterval / scene.time_step)));
  if (scene.recording) recording = *scene.recording;
  if (options.every && *options.every < 0) {
    throw InputError(
        fmt::format("--every is {}, but must be >= 0; 0 writes no frames", *options.every));
  }
  recording.every = options.every.value_or(recording.every);
  if (options.frames_alone && recording.every == 0) {
    throw InputError(
        "--frames-alone wants frames, but --every 0 writes none; leave one of them out");
  }
  recording.frames_alone = options.frames_alone;
  recording.surface_alone = options.surface_alone;
  return recording;
}

/// Steps until done, interrupted or not finite; returns the exit code.
int simulate(World& world, std::uint64_t steps, bool show_progress, Recording* recording,
             RunStatistics& statistics) {
  ProgressBar bar(show_progress);
  Timer timer;
  std::uint64_t before = world.steps();
  bool stopped = false;
  const auto look = [&](const World& now) {
    statistics.add(now, timer.seconds(), now.steps() - before);
    if (recording != nullptr) recording->add_step(now);
    bar.update(now.steps(), steps, now.time());
    stopped = interrupted();
    before = now.steps();
    timer = Timer();
    return !stopped;
  };
  if (recording != nullptr) recording->add_frame(world);
  const int every = recording != nullptr ? recording->steps_between() : kMostInSeries;
  const auto wants = [&] { return recording != nullptr ? recording->wanted() : Wanted::kNothing; };
  const int most = std::max(every, kMostAtOnce / every * every);  // so that looks fall on frames
  while (world.steps() < steps) {
    if (stopped || interrupted()) return kInterrupted;
    const auto left = std::min<std::uint64_t>(static_cast<std::uint64_t>(most), steps - before);
    if (!world.advance(static_cast<int>(left), every, look, wants)) return kNotFinite;
  }
  return kOk;
}

/// How the solver of each body fared in the last step.
void print_last_step(const World& world) {
  for (const Body& body : world.bodies()) {
    const StepReport& report = body.report;
    const std::string why =
        report.backend_reason.empty() ? "" : " (auto: " + report.backend_reason + ")";
    fmt::print("last step of {}: {} iterations of {} on {}{}, ended by {}, residual {:.2g}",
               body.name, report.iterations, report.solver, report.backend, why,
               to_string(report.ended_by), report.residual);
    if (!report.time_integration.empty()) fmt::print(", by {}", report.time_integration);
    if (!report.first_order.empty()) fmt::print(" at first order ({})", report.first_order);
    if (report.error) fmt::print(", error about {:.2g}", *report.error);
    if (report.impulse_imbalance) {
      fmt::print(", impulse imbalance {:.2g}", *report.impulse_imbalance);
    }
    if (report.energy_gained) fmt::print(", energy gained {:.2g} J", *report.energy_gained);
    for (const Figure& figure : report.figures)
      fmt::print(", {} {:.6g}", figure.name, figure.value);
    fmt::print("\n");
  }
}

void print_summary(const LoadedScene& scene, const RunStatistics& statistics) {
  const World& world = *scene.world;
  fmt::print("{}: {} steps of {:g} s = {:g} s, in {:.3f} s ({:.3g} times real time)\n",
             scene.spec.name, statistics.steps(), world.time_step(), world.time(),
             statistics.seconds(), world.time() / std::max(statistics.seconds(), 1e-12));
  const double count = static_cast<double>(std::max<std::uint64_t>(1, statistics.steps()));
  fmt::print("step time: mean {:.4f} ms, longest {:.4f} ms\n", 1e3 * statistics.seconds() / count,
             1e3 * statistics.longest());
  for (const auto& [name, seconds] : statistics.phases()) {
    fmt::print("  {:<16} {:5.1f} %  {:.4f} ms\n", name,
               100.0 * seconds / std::max(statistics.seconds(), 1e-12), 1e3 * seconds / count);
  }
  const Energies energies = world.energies();
  fmt::print("energy at the end: kinetic {:.6g} J, elastic {:.6g} J, potential {:.6g} J\n",
             energies.kinetic, energies.elastic, energies.potential);
  print_last_step(world);
  int contacts = 0;
  for (const Body& body : world.bodies()) contacts += body.report.contacts;
  fmt::print("contacts at the end: {}\n", contacts);
  for (const auto& [text, times] : statistics.first_order()) {
    fmt::print("at first order: {} in {} {}\n", text, times, times == 1 ? "step" : "steps");
  }
  for (const auto& [text, times] : statistics.warnings()) {
    fmt::print("warning ({} {}): {}\n", times, times == 1 ? "step" : "steps", text);
  }
  std::fflush(stdout);
}

/// The scenes of --batch and --vary.
SceneValueTable batch_table(const RunOptions& options) {
  SceneValueTable table;
  if (!options.vary.empty()) table = read_scene_values(options.vary);
  const int rows = static_cast<int>(table.rows.size());
  const int scenes = options.batch.value_or(rows);
  if (scenes < 1 || scenes > kMaxScenes) {
    throw InputError(
        fmt::format("--batch is {}, but must be from 1 to {} scenes", scenes, kMaxScenes));
  }
  if (!options.vary.empty() && scenes != rows) {
    throw InputError(fmt::format("--batch is {}, but {} has {} rows; leave --batch out", scenes,
                                 options.vary, rows));
  }
  table.rows.resize(static_cast<std::size_t>(scenes));
  return table;
}

int run_scenes(const RunOptions& options) {
  const SceneValueTable table = batch_table(options);
  if (options.every && *options.every < 0) {
    throw InputError(fmt::format("--every is {}, but must be >= 0", *options.every));
  }
  Batch batch(options.scene.path, scene_overrides(options.scene), table.rows);
  for (const std::string& warning : batch.warnings()) {
    std::cerr << "warning: " << options.scene.path << ": " << warning << std::endl;
  }
  catch_interrupts();
  BatchOutput output;
  output.folder = options.out;
  output.every = static_cast<std::uint64_t>(options.every.value_or(0));
  output.overwrite = options.overwrite;
  output.progress = !options.quiet && (options.progress || isatty(STDERR_FILENO) != 0);
  output.quiet = options.quiet;
  return run_batch(batch, table, count_steps(options, batch.spec().time_step), output);
}

int run_scene(const RunOptions& options) {
  const bool are_many = options.batch || !options.vary.empty();
  if (options.frames_alone && (are_many || options.out.empty())) {
    throw InputError(
        "--frames-alone is for the recording of one scene: give --out DIR, and leave --batch and "
        "--vary out");
  }
  if (options.surface_alone && !options.frames_alone) {
    throw InputError("--surface-alone is for --frames-alone: give both, or leave it out");
  }
  if (are_many) return run_scenes(options);
  LoadedScene scene = load_scene(options.scene);
  const std::uint64_t steps = count_steps(options, scene.spec.time_step);
  catch_interrupts();
  std::optional<Recording> recording;
  if (!options.out.empty()) {
    recording.emplace(options.out, recording_options(options, scene.spec), options.overwrite);
  }
  const bool show_progress = !options.quiet && (options.progress || isatty(STDERR_FILENO) != 0);
  RunStatistics statistics;
  const int code =
      simulate(*scene.world, steps, show_progress, recording ? &*recording : nullptr, statistics);
  if (recording) {
    if (code != kOk) recording->add_frame(*scene.world);
    recording->finish();
  }
  if (!options.quiet) print_summary(scene, statistics);
  if (!options.quiet && recording) {
    fmt::print("written: {0}/steps.csv and {1} surface files in {0}/frames\n",
               recording->directory(), recording->frames());
  }
  if (code == kNotFinite) std::cerr << "error: " << scene.world->failure() << std::endl;
  if (code == kInterrupted) {
    std::cerr << "interrupted after step " << scene.world->steps() << std::endl;
  }
  return code;
}

}  // namespace

void add_run_command(CLI::App& app, int& exit_code) {
  CLI::App* command =
      add_command(app, "run", "Simulate a scene; record and summarise what happens");
  auto options = std::make_shared<RunOptions>();
  add_scene_options(*command, options->scene);
  command->add_option("--steps", options->steps, "How many time steps to take")->type_name("N");
  command->add_option("--duration", options->duration, "Or how long to simulate [s]")
      ->type_name("S");
  command
      ->add_option("--out", options->out,
                   "Folder for steps.csv and frames/; nothing is written without it")
      ->type_name("DIR");
  command->add_option("--every", options->every,
                      "A surface frame each so many steps, 0 none; 30 frames a simulated second "
                      "unless this or the scene's `recording` says. Of a batch: a row of each "
                      "scene in scenes.csv; the last step's alone unless this says");
  command->add_flag("--frames-alone", options->frames_alone,
                    "No rows in steps.csv of the steps between frames: where a GPU keeps the body, "
                    "it takes them on end, and the next ones while a frame is written");
  command->add_flag("--surface-alone", options->surface_alone,
                    "With --frames-alone: frames without point fields and rows without energies, "
                    "so that a GPU that keeps the body sends its surface alone");
  command
      ->add_option("--batch", options->batch,
                   "Simulate N copies side by side; with --out they leave scenes.csv and "
                   "positions_BODY.npy; see docs/batch.md")
      ->type_name("N");
  command
      ->add_option("--vary", options->vary,
                   "What differs between the copies: the first line names values of the scene "
                   "file, as bodies[0].material.areal_density, each further line is a scene")
      ->type_name("TABLE.csv");
  command->add_flag("--overwrite", options->overwrite, "Replace a recording that is in DIR");
  command->add_flag("--progress", options->progress,
                    "Show the bar where stderr is no terminal too");
  command->add_flag("--quiet", options->quiet, "Print nothing but errors and warnings");
  command->callback([options, &exit_code] { exit_code = run_scene(*options); });
}

}  // namespace pliant
