#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <charconv>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "pliant/app/batch/batch_run.h"
#include "pliant/app/commands/commands.h"
#include "pliant/app/interrupt.h"
#include "pliant/app/progress_bar.h"
#include "pliant/app/run_statistics.h"
#include "pliant/app/scene_options.h"
#include "pliant/core/parallel/parallel.h"
#include "pliant/math/error.h"
#include "pliant/scene/recording.h"

namespace pliant {
namespace {

constexpr double kFrameInterval = 1.0 / 30.0;  // of the frames unless the scene says [s]
constexpr double kMaxSteps = 1e12;
constexpr int kMaxScenes = 1000000;
constexpr double kBatchMemory = 1000;   // [MB]
constexpr int kMostInResidentRun = 50;  // between two looks at Ctrl-C and the bar
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
  std::string rows;
  std::vector<std::string> trajectory;
  std::optional<double> memory;      // [MB]
  std::optional<double> checkpoint;  // [s]
  bool resume = false;
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
  const auto observe = [&](const World& now) {
    statistics.add(now, timer.seconds(), now.steps() - before);
    if (recording != nullptr) recording->add_step(now);
    bar.update(now.steps(), steps, now.time());
    stopped = interrupted();
    before = now.steps();
    timer = Timer();
    return !stopped;
  };
  if (recording != nullptr) recording->add_frame(world);
  const int every = recording != nullptr ? recording->steps_between() : kMostInResidentRun;
  const auto next_readback = [&] {
    return recording != nullptr ? recording->readback() : Readback::kNothing;
  };
  const int most =
      std::max(every, kMostAtOnce / every * every);  // so that observations fall on frames
  while (world.steps() < steps) {
    if (stopped || interrupted()) return kInterrupted;
    const auto left = std::min<std::uint64_t>(static_cast<std::uint64_t>(most), steps - before);
    if (!world.advance(static_cast<int>(left), every, observe, next_readback)) return kNotFinite;
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
    for (const Metric& metric : report.metrics)
      fmt::print(", {} {:.6g}", metric.name, metric.value);
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
  for (const SceneRobot& robot : scene.robots) {
    if (robot.driver == nullptr) continue;
    for (const std::string& note : robot.driver->notes()) fmt::print("note: {}\n", note);
  }
  std::fflush(stdout);
}

/// The scenes of --batch and --vary.
SceneTable batch_table(const RunOptions& options) {
  SceneTable table = options.vary.empty() ? SceneTable(0) : SceneTable(options.vary);
  const int rows = static_cast<int>(table.size());
  const int scenes = options.batch.value_or(rows);
  if (scenes < 1 || scenes > kMaxScenes) {
    throw InputError(
        fmt::format("--batch is {}, but must be from 1 to {} scenes", scenes, kMaxScenes));
  }
  if (!options.vary.empty() && scenes != rows) {
    throw InputError(fmt::format("--batch is {}, but {} has {} rows; leave --batch out", scenes,
                                 options.vary, rows));
  }
  return options.vary.empty() ? SceneTable(static_cast<std::size_t>(scenes)) : std::move(table);
}

/// "A:B", "A:" or ":B" of so many rows.
std::pair<std::size_t, std::size_t> parse_rows(const std::string& text, std::size_t rows) {
  const std::size_t colon = text.find(':');
  const auto number = [&](const std::string& part, std::size_t otherwise) {
    std::size_t value = otherwise;
    const char* end = part.data() + part.size();
    const bool is_whole = part.empty() || std::from_chars(part.data(), end, value).ptr == end;
    return is_whole ? value : std::numeric_limits<std::size_t>::max();
  };
  if (text.empty()) return {0, rows};
  if (colon != std::string::npos) {
    const std::size_t begin = number(text.substr(0, colon), 0);
    const std::size_t end = number(text.substr(colon + 1), rows);
    if (begin < end && end <= rows) return {begin, end};
  }
  throw InputError(
      fmt::format("--rows is '{}', but must be A:B with 0 <= A < B <= {}: the scenes from A up to, "
                  "and without, B",
                  text, rows));
}

BatchFolder::Start batch_start(const RunOptions& options) {
  if (options.resume && options.overwrite) {
    throw InputError("--resume and --overwrite exclude each other");
  }
  if (options.resume) return BatchFolder::Start::kResume;
  return options.overwrite ? BatchFolder::Start::kOverwrite : BatchFolder::Start::kNew;
}

BatchOutput batch_output(const RunOptions& options) {
  BatchOutput output;
  output.folder = options.out;
  output.start = batch_start(options);
  output.every = static_cast<std::uint64_t>(options.every.value_or(0));
  output.trajectory = parse_trajectory(options.trajectory);
  output.checkpoint = options.checkpoint.value_or(0.0);
  output.memory = 1e6 * options.memory.value_or(kBatchMemory);
  output.progress = !options.quiet && (options.progress || isatty(STDERR_FILENO) != 0);
  output.quiet = options.quiet;
  const bool wants_files = options.resume || !options.trajectory.empty() || options.checkpoint;
  if (output.folder.empty() && wants_files) {
    throw InputError("--resume, --trajectory and --checkpoint are of files: give --out DIR");
  }
  if (options.checkpoint && !(output.checkpoint > 0.0)) {
    throw InputError(fmt::format("--checkpoint is {}, but must be > 0 s", *options.checkpoint));
  }
  if (!(output.memory > 0.0)) {
    throw InputError(fmt::format("--memory is {}, but must be > 0 MB", *options.memory));
  }
  return output;
}

int run_scenes(const RunOptions& options) {
  SceneTable table = batch_table(options);
  if (options.every && *options.every < 0) {
    throw InputError(fmt::format("--every is {}, but must be >= 0", *options.every));
  }
  BatchInput input;
  input.scene = options.scene.path;
  input.overrides = scene_overrides(options.scene);
  std::tie(input.begin, input.end) = parse_rows(options.rows, table.size());
  input.steps = [&](double time_step) { return count_steps(options, time_step); };
  input.settings = fmt::format("{} {} {} {}", options.scene.solver.value_or(""),
                               fmt::join(options.scene.settings, " "),
                               options.scene.time_integration.value_or(""), table.size());
  return run_batch(input, table, batch_output(options));
}

/// Options of a batch, or of one scene, are told where they do nothing.
void refuse_misplaced(const RunOptions& options, bool are_many) {
  const std::pair<const char*, bool> of_batches[] = {
      {"--rows", !options.rows.empty()},
      {"--memory", options.memory.has_value()},
      {"--trajectory", !options.trajectory.empty()},
      {"--checkpoint", options.checkpoint.has_value()},
      {"--resume", options.resume}};
  for (const auto& [name, is_given] : of_batches) {
    if (is_given && !are_many) {
      throw InputError(fmt::format("{} is for many scenes: give --vary TABLE or --batch N", name));
    }
  }
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
  refuse_misplaced(options, are_many);
  if (are_many) return run_scenes(options);
  SceneOverrides overrides = scene_overrides(options.scene);
  overrides.usual_threads = usual_threads();
  LoadedScene scene = load_scene(options.scene, overrides);
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
  command
      ->add_option("--rows", options->rows,
                   "Of these scenes those from A up to, and without, B, counted from 0")
      ->type_name("A:B");
  command
      ->add_option("--trajectory", options->trajectory,
                   "Of a batch: every:N fields:positions,velocities,points,wrenches,contacts; a "
                   "frame of each scene each N steps, in trajectory_*; see docs/batch.md")
      ->type_name("every:N fields:F,G")
      ->expected(1, 2);
  command
      ->add_option("--memory", options->memory,
                   "About what the scenes of a batch may take at once [MB]; as many as fit run "
                   "side by side, 1000 unless this says")
      ->type_name("MB");
  command
      ->add_option("--checkpoint", options->checkpoint,
                   "Keep the states of a batch's scenes amid their steps, each so many seconds and "
                   "on Ctrl-C, for --resume; else those that are not finished begin anew")
      ->type_name("S");
  command->add_flag("--resume", options->resume,
                    "Go on with the batch that is in DIR, or begin it: scenes that are finished "
                    "are not run again");
  command->add_flag("--overwrite", options->overwrite, "Replace a recording that is in DIR");
  command->add_flag("--progress", options->progress,
                    "Show the bar where stderr is no terminal too");
  command->add_flag("--quiet", options->quiet, "Print nothing but errors and warnings");
  command->callback([options, &exit_code] { exit_code = run_scene(*options); });
}

}  // namespace pliant
