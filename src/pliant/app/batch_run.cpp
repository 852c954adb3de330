#include "pliant/app/batch_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>

#include "pliant/app/commands.h"
#include "pliant/app/interrupt.h"
#include "pliant/app/progress_bar.h"
#include "pliant/geometry/atomic_file.h"
#include "pliant/geometry/numpy_file.h"
#include "pliant/math/error.h"
#include "pliant/scene/table_cell.h"
#include "pliant/scene/wrenches.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTable = "scenes.csv";
constexpr int kMostScenesTold = 10;

/// The rows of scenes.csv.
class BatchRows {
 public:
  BatchRows(const Batch& batch, const SceneValueTable& table) : batch_(batch), table_(table) {
    text_ = "scene";
    for (const std::string& path : table.paths) text_ += "," + table_cell(path);
    text_ +=
        ",body,step,time,iterations,residual,error,impulse_imbalance,energy_gained,contacts,"
        "kinetic,"
        "elastic,potential,center_x,center_y,center_z,lowest_z,highest_z";
    // Scenes of a batch may have other obstacles than the first: each is found by its name.
    names_ = zero_wrenches(batch.world(0).obstacles());
    text_ += wrench_columns(names_) + ",failure\n";
  }

  void add() {
    for (int s = 0; s < batch_.size(); ++s) {
      const std::string wrenches = wrench_cells(wrenches_of(batch_.world(s)));
      for (const Body& body : batch_.world(s).bodies()) add(s, body, wrenches);
    }
  }
  const std::string& text() const { return text_; }

 private:
  /// Of its last step, in the order of the columns.
  std::vector<Wrench> wrenches_of(const World& world) const {
    WrenchAverage average(world.obstacles());
    average.add(world.obstacles(), world.reactions());
    std::vector<Wrench> wrenches = names_;
    for (const Wrench& own : average.take()) {
      const auto same = [&](const Wrench& known) { return known.name == own.name; };
      const auto found = std::find_if(wrenches.begin(), wrenches.end(), same);
      if (found != wrenches.end()) *found = own;
    }
    return wrenches;
  }

  void add(int scene, const Body& body, const std::string& wrenches) {
    const World& world = batch_.world(scene);
    text_ += std::to_string(scene);
    const auto row = static_cast<std::size_t>(scene);
    if (!table_.paths.empty()) {
      for (const SceneValue& value : table_.rows[row]) text_ += "," + table_cell(value.text);
    }
    const StepReport& report = body.report;
    const Energies energies = world.energies();
    const Particles& p = body.particles();
    const Eigen::Vector3d center = p.center_of_mass();
    text_ += fmt::format(
        ",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}{},{}\n", table_cell(body.name),
        world.steps(), world.time(), report.iterations, report.residual, text_of(report.error),
        text_of(report.impulse_imbalance), text_of(report.energy_gained), report.contacts,
        energies.kinetic, energies.elastic, energies.potential, center[0], center[1], center[2],
        p.x.row(2).minCoeff(), p.x.row(2).maxCoeff(), wrenches, table_cell(batch_.failure(scene)));
  }

  const Batch& batch_;
  const SceneValueTable& table_;
  std::vector<Wrench> names_;  // of the first scene
  std::string text_;
};

/// One file a body; none where scenes have other numbers of particles. Returns how many.
int write_positions(const Batch& batch, const std::string& folder) {
  int files = 0;
  for (std::size_t b = 0; b < batch.world(0).bodies().size(); ++b) {
    const Body& first = batch.world(0).bodies()[b];
    const auto count = static_cast<std::size_t>(first.particles().size());
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(batch.size()) * count * 3);
    bool is_alike = true;
    for (int s = 0; s < batch.size() && is_alike; ++s) {
      const auto& bodies = batch.world(s).bodies();
      is_alike =
          b < bodies.size() && static_cast<std::size_t>(bodies[b].particles().size()) == count;
      if (!is_alike) break;
      const Positions& x = bodies[b].particles().x;
      values.insert(values.end(), x.data(), x.data() + x.size());
    }
    if (!is_alike) continue;
    const std::string name = "positions_" + first.name + ".npy";
    write_npy((fs::path(folder) / name).string(),
              {static_cast<std::size_t>(batch.size()), count, 3}, values);
    ++files;
  }
  return files;
}

void prepare_folder(const BatchOutput& output) {
  const fs::path table = fs::path(output.folder) / kTable;
  if (fs::exists(table) && !output.overwrite) {
    throw InputError(table.string() +
                     " is there already; choose another folder or give --overwrite");
  }
  std::error_code error;
  fs::create_directories(output.folder, error);
  if (error) {
    throw InputError(fmt::format("cannot make folder '{}': {}", output.folder, error.message()));
  }
}

int count_failures(const Batch& batch) {
  int count = 0;
  for (int s = 0; s < batch.size(); ++s) count += batch.failure(s).empty() ? 0 : 1;
  return count;
}

void print_failures(const Batch& batch) {
  int told = 0;
  for (int s = 0; s < batch.size(); ++s) {
    if (batch.failure(s).empty()) continue;
    if (++told > kMostScenesTold) {
      std::cerr << "... and more; see column failure\n";
      return;
    }
    std::cerr << "error: scene " << s << ": " << batch.failure(s) << "\n";
  }
}

/// Scenes with a body whose last step ran on a GPU.
int count_on_gpu(const Batch& batch) {
  int count = 0;
  for (int s = 0; s < batch.size(); ++s) {
    const auto& bodies = batch.world(s).bodies();
    const auto is_there = [](const Body& body) { return body.report.backend == "cuda"; };
    count += std::any_of(bodies.begin(), bodies.end(), is_there) ? 1 : 0;
  }
  return count;
}

/// Each warning with the number of scenes that gave it.
void print_warnings(const Batch& batch) {
  std::map<std::string, int> warnings;
  for (int s = 0; s < batch.size(); ++s) {
    for (const std::string& warning : batch.step_warnings(s)) ++warnings[warning];
  }
  for (const auto& [text, scenes] : warnings) {
    fmt::print("warning ({} scene{}): {}\n", scenes, scenes == 1 ? "" : "s", text);
  }
}

}  // namespace

int run_batch(Batch& batch, const SceneValueTable& table, std::uint64_t steps,
              const BatchOutput& output) {
  if (!output.folder.empty()) prepare_folder(output);
  BatchRows rows(batch, table);
  ProgressBar bar(output.progress);
  double seconds = 0.0;
  std::uint64_t done = 0;
  while (done < steps && !interrupted()) {
    // Ctrl-C is heard after each portion.
    constexpr std::uint64_t kMost = 20;
    std::uint64_t count = std::min(kMost, steps - done);
    if (output.every > 0) count = std::min(count, output.every - done % output.every);
    const Timer own;
    batch.step(static_cast<int>(count));
    seconds += own.seconds();
    done += count;
    if (done == steps || (output.every > 0 && done % output.every == 0)) rows.add();
    bar.update(done, steps, static_cast<double>(done) * batch.spec().time_step);
  }
  bar.clear();
  const int failures = count_failures(batch);
  if (!output.folder.empty() && done == steps) {
    write_file_atomically((fs::path(output.folder) / kTable).string(), rows.text());
    const int files = write_positions(batch, output.folder);
    if (!output.quiet) {
      fmt::print("written: {0}/{1} and {2} file{3} of positions\n", output.folder, kTable, files,
                 files == 1 ? "" : "s");
    }
  }
  if (!output.quiet) {
    fmt::print(
        "{}: {} scenes, {} steps of {:g} s each, in {:.3f} s: {:.4g} scene-steps a second; "
        "{} on the GPU, {} stopped\n",
        batch.spec().name, batch.size(), done, batch.spec().time_step, seconds,
        static_cast<double>(done) * batch.size() / std::max(seconds, 1e-12), count_on_gpu(batch),
        failures);
    print_warnings(batch);
  }
  std::fflush(stdout);
  print_failures(batch);
  if (done < steps) {
    std::cerr << "interrupted after step " << done << "; nothing is written\n";
    return kInterrupted;
  }
  return failures > 0 ? kNotFinite : kOk;
}

}  // namespace pliant
